//! Scenes of shapes from a seed: ordinary ones, and hard cases of each data structure.

use std::f32::consts::PI;

use jostle_index::Each;
use jostle_scenes::random::Random;

/// Fraction of the area that shapes cover, unless stated otherwise.
const COVERAGE: f32 = 0.4;

/// Shapes as columns, the same for every library. `half` is empty if all are discs.
#[derive(Debug, Default)]
pub struct Shapes {
    /// Centres, x.
    pub x: Vec<f32>,
    /// Centres, y.
    pub y: Vec<f32>,
    /// Radii.
    pub radius: Vec<f32>,
    /// Half widths and half heights; empty if all shapes are discs.
    pub half: [Vec<f32>; 2],
}

impl Shapes {
    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether the shapes are rectangles.
    pub fn has_boxes(&self) -> bool {
        !self.half[0].is_empty()
    }

    /// The same as rows, for jostle's core.
    pub fn rows(&self) -> jostle_index::Shapes<f32> {
        let pairs = |[a, b]: [&[f32]; 2]| a.iter().zip(b).map(|(&a, &b)| [a, b]).collect();
        let half_sizes = || Each::Rows(pairs(self.half.each_ref().map(Vec::as_slice)));
        let centers = pairs([&self.x, &self.y]);
        let radii = Each::Rows(self.radius.clone());
        let half_sizes = self.has_boxes().then(half_sizes);
        jostle_index::Shapes::new(centers, radii, half_sizes, None)
            .expect("scenes hold valid shapes")
    }

    /// Half the width and height of the box around the shape in `row`.
    pub fn reach(&self, row: usize) -> [f32; 2] {
        let radius = self.radius[row];
        if self.has_boxes() {
            self.half.each_ref().map(|half| half[row] + radius)
        } else {
            [radius; 2]
        }
    }
}

/// A scene by its name.
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// Makes it with a number of shapes.
    pub make: fn(usize, &mut Random) -> Shapes,
}

/// All scenes.
pub const SCENES: [Scene; 4] = [
    Scene { name: "uniform", make: uniform },
    Scene { name: "mixed", make: mixed },
    Scene { name: "clusters", make: clusters },
    Scene { name: "rectangles", make: rectangles },
];

/// Equal discs at random places in a square: the best case of a uniform grid.
fn uniform(count: usize, random: &mut Random) -> Shapes {
    let radius = vec![0.5; count];
    let side = (count as f32 * PI * 0.25 / COVERAGE).sqrt();
    let (x, y) = anywhere(count, side, random);
    Shapes { x, y, radius, ..Shapes::default() }
}

/// Radii from 1 to 100, every octave covering the same area: many small, few large.
fn mixed(count: usize, random: &mut Random) -> Shapes {
    let share = 1.0 - 1e-4;
    let radius: Vec<f32> =
        (0..count).map(|_| (1.0 / (1.0 - random.unit() * share).sqrt()).min(100.0)).collect();
    let covered: f64 = radius.iter().map(|&r| f64::from(PI * r * r)).sum();
    let side = (covered / f64::from(COVERAGE)).sqrt() as f32;
    let (x, y) = anywhere(count, side, random);
    Shapes { x, y, radius, ..Shapes::default() }
}

/// Gaussian clusters of equal discs. The densest is 30 times narrower than the widest. The area of
/// the world is 900 times that of the clusters; a tenth of the discs are at random places in it.
fn clusters(count: usize, random: &mut Random) -> Shapes {
    const CROWDS: usize = 24;
    let need = (count as f32 * PI * 0.25 / COVERAGE).sqrt();
    let side = 30.0 * need;
    let (mut x, mut y) = anywhere(count, side, random);
    // Equal numbers in all clusters; in the narrowest a disc touches about eight others.
    let narrow = 0.12 * need / (CROWDS as f32).sqrt();
    for crowd in 0..CROWDS {
        let width = narrow * 30f32.powf(crowd as f32 / (CROWDS - 1) as f32);
        let middle = [0, 1].map(|_| side * random.between(0.1, 0.9));
        let crowded = count * 9 / 10;
        for row in crowded * crowd / CROWDS..crowded * (crowd + 1) / CROWDS {
            x[row] = middle[0] + width * normal(random);
            y[row] = middle[1] + width * normal(random);
        }
    }
    // The order of the discs must not depend on the clusters.
    for row in (1..count).rev() {
        let other = (random.unit() * row as f32) as usize;
        x.swap(row, other);
        y.swap(row, other);
    }
    Shapes { x, y, radius: vec![0.5; count], ..Shapes::default() }
}

/// Rectangles of any proportion, sides from 1 to 16 with a power law.
fn rectangles(count: usize, random: &mut Random) -> Shapes {
    let share = 1.0 - 1.0 / 256.0;
    let mut length = || 0.5 / (1.0 - random.unit() * share).sqrt();
    let half: [Vec<f32>; 2] = [0, 1].map(|_| (0..count).map(|_| length()).collect());
    let sides = half[0].iter().zip(&half[1]);
    let covered: f64 = sides.map(|(&w, &h)| 4.0 * f64::from(w) * f64::from(h)).sum();
    let side = (covered / f64::from(COVERAGE)).sqrt() as f32;
    let (x, y) = anywhere(count, side, random);
    Shapes { x, y, radius: vec![0.0; count], half }
}

fn anywhere(count: usize, side: f32, random: &mut Random) -> (Vec<f32>, Vec<f32>) {
    (0..count).map(|_| (side * random.unit(), side * random.unit())).unzip()
}

/// About normal: the sum of twelve uniform numbers, less six.
fn normal(random: &mut Random) -> f32 {
    (0..12).map(|_| random.unit()).sum::<f32>() - 6.0
}
