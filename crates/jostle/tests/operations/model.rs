//! The model of a space: a map of shapes by ids, without a tree. Pairs are found by two loops.

use std::collections::BTreeMap;

use jostle_base::Id;
use jostle_index::{Each, Period, Scalar, Shape, Shapes};

use super::driver::Draw;
use super::formulas;

pub struct Model<T> {
    pub period: Period<T>,
    pub shapes: BTreeMap<Id, Shape<T>>,
    /// Ids of removed shapes.
    pub gone: Vec<Id>,
    /// The ids of all shapes, in the order of adding.
    added: Vec<Id>,
}

impl<T: Scalar> Model<T> {
    /// Every other plane is periodic, along one axis or along both.
    pub fn new(draw: &mut Draw) -> Self {
        let sides = [[0.0; 2], [0.0; 2], [8.0, 8.0], [9.5, 0.0], [0.0, 6.0], [33.0, 7.0]];
        let period = Period::new(draw.pick(&sides).map(T::from_f64)).expect("valid");
        Self { period, shapes: BTreeMap::new(), gone: Vec::new(), added: Vec::new() }
    }

    pub fn ids(&self) -> Vec<Id> {
        self.added.clone()
    }

    /// Adds shapes with new ids.
    pub fn add(&mut self, ids: &[Id], shapes: &Shapes<T>) {
        assert_eq!(ids.len(), shapes.len());
        self.added.extend(ids);
        for (row, id) in ids.iter().enumerate() {
            assert!(*id >= 0 && !self.gone.contains(id), "{id} is given twice");
            let shape = self.period.wrap_shape(shapes.shape(row));
            assert_eq!(self.shapes.insert(*id, shape), None, "{id} is given twice");
        }
    }

    pub fn remove(&mut self, ids: &[Id]) {
        ids.iter().for_each(|id| assert!(self.shapes.remove(id).is_some()));
        self.gone.extend(ids);
        self.added.retain(|id| !ids.contains(id));
    }

    /// Changes shapes; each function gets a shape and its row in `ids`.
    pub fn change(&mut self, ids: &[Id], change: impl Fn(&mut Shape<T>, usize)) {
        for (row, id) in ids.iter().enumerate() {
            change(self.shapes.get_mut(id).expect("it is there"), row);
        }
    }

    pub fn pairs(&self, distance: T, mask: Option<u32>) -> Vec<[Id; 2]> {
        formulas::pairs(self.shapes.iter(), &self.period, (distance, mask))
    }
}

/// Moves a shape. One given as a box becomes its centre and half its size.
pub fn place<T: Scalar>(shape: &mut Shape<T>, center: [T; 2]) {
    if shape.center() != center {
        shape.half_size = shape.core_half_size();
        (shape.min, shape.max) = (center, center);
    }
}

/// Sets the half size of a shape in the same way.
pub fn resize<T: Scalar>(shape: &mut Shape<T>, half_size: [T; 2]) {
    if shape.core_half_size() != half_size {
        let center = shape.center();
        *shape = Shape { min: center, max: center, half_size, ..*shape };
    }
}

/// Shapes of one kind: circles, rounded boxes, or boxes given by their sides; with and without filters.
pub fn draw_shapes<T: Scalar>(draw: &mut Draw, most: usize) -> Shapes<T> {
    let centers: Vec<[T; 2]> = draw.some(most, Draw::point);
    let len = centers.len();
    let sizes = |draw: &mut Draw| -> Each<T> {
        if draw.one_in(3) {
            Each::One(draw.size())
        } else {
            Each::Rows((0..len).map(|_| draw.size()).collect())
        }
    };
    // Equal circles on a lattice have many equal distances.
    let radii = if draw.one_in(4) { Each::One(T::ZERO) } else { sizes(draw) };
    let filters =
        draw.one_in(2).then(|| [0, 1].map(|_| Each::Rows((0..len).map(|_| draw.bits()).collect())));
    let halves: Vec<[T; 2]> = (0..len).map(|_| [draw.size(), draw.size()]).collect();
    match draw.below(4) {
        0 => {
            let corner = |(&[x, y], &[w, h]): (&[T; 2], &[T; 2])| [x, y, x + w, y + h];
            let boxes = centers.iter().zip(&halves).map(corner).collect();
            let radii = if draw.one_in(2) { Each::One(T::ZERO) } else { radii };
            Shapes::from_boxes(boxes, radii, filters)
        }
        1 => Shapes::new(centers, radii, Some(Each::Rows(halves)), filters),
        _ => Shapes::new(centers, radii, None, filters),
    }
    .expect("the numbers are valid")
}
