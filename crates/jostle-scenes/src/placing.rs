//! Positions of discs: lattices, random positions without overlap, and walls of discs.

use std::collections::HashMap;
use std::ops::Range;

use super::random::Random;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;

/// A rectangle: min x, min y, max x, max y.
pub(crate) type Area = [f32; 4];

/// Attempts to find a free position before an overlap is accepted.
const TRIES: usize = 200;

/// Distance between the discs of a wall, in radii: its surface is flat up to 2 % of a radius.
const BEAD_STEP: f32 = 0.4;

/// `count` positions on a square lattice that fills `area`, each displaced by up to `jitter` along
/// both axes.
pub(crate) fn lattice(
    count: usize,
    area: Area,
    jitter: f32,
    random: &mut Random,
) -> Result<Vec<[f32; 2]>> {
    memory::collect(lattice_places(count, area, jitter, random))
}

/// The positions of [`lattice`], computed one after the other.
pub(crate) fn lattice_places(
    count: usize,
    area: Area,
    jitter: f32,
    random: &mut Random,
) -> impl ExactSizeIterator<Item = [f32; 2]> {
    // Columns in proportion to the width, so that cells are about square.
    let [width, height] = [area[2] - area[0], area[3] - area[1]];
    let columns = ((count as f32 * width / height).sqrt().ceil() as usize).max(1);
    let rows = count.div_ceil(columns).max(1);
    let step = [width / columns as f32, height / rows as f32];
    let place = move |index: usize| {
        let cell = [(index % columns) as f32 + 0.5, (index / columns) as f32 + 0.5];
        [0, 1].map(|k| area[k] + cell[k] * step[k] + random.between(-jitter, jitter))
    };
    (0..count).map(place)
}

/// As [`lattice`], with only positions for which `is_free` holds: the lattice gets finer until there are
/// enough.
pub(crate) fn lattice_where(
    count: usize,
    area: Area,
    jitter: f32,
    random: &mut Random,
    is_free: impl Fn(&[f32; 2]) -> bool,
) -> Result<Vec<[f32; 2]>> {
    let mut cells = count;
    loop {
        let mut places = lattice(cells, area, jitter, random)?;
        places.retain(&is_free);
        if places.len() >= count {
            places.truncate(count);
            return Ok(places);
        }
        cells += cells / 20 + 1;
    }
}

/// The values of the particles in `rows`. All values are made, so that random numbers do not depend
/// on it.
pub(crate) fn kept<V>(rows: &Range<usize>, values: impl Iterator<Item = V>) -> Result<Vec<V>> {
    // A rank that makes its own rows has to draw the random numbers of all rows before them, or the
    // parts would not be those of the whole.
    let values = values.enumerate().filter(|(row, _)| rows.contains(row)).map(|(_, value)| value);
    let mut all = Vec::new();
    memory::extend(&mut all, values)?;
    Ok(all)
}

/// The centres of discs of `radius` in a straight line from `start` to `end`, so close that
/// particles slide along them as along a smooth wall.
fn wall(start: [f32; 2], end: [f32; 2], radius: f32) -> Result<Vec<[f32; 2]>> {
    let offset = [0, 1].map(|k| f64::from(end[k]) - f64::from(start[k]));
    let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
    // Discs at 0.4 radii: between two of them the surface is lower by r (1 - √(1 - 0.04)), 2 % of
    // the radius.
    let steps = (length / (f64::from(BEAD_STEP) * f64::from(radius))).ceil();
    let bead = |index: u32| {
        let share = f64::from(index) / steps.max(1.0);
        [0, 1].map(|k| (f64::from(start[k]) + offset[k] * share) as f32)
    };
    memory::collect((0..steps as u32 + 1).map(bead))
}

/// The discs of walls between consecutive corners.
pub(crate) fn walls(corners: &[[f32; 2]], radius: f32) -> Result<Vec<[f32; 2]>> {
    let mut all = Vec::new();
    for ends in corners.windows(2) {
        memory::append(&mut all, &wall(ends[0], ends[1], radius)?)?;
    }
    Ok(all)
}

/// Immovable discs of equal radius.
pub(crate) fn immovable(places: Vec<[f32; 2]>, radius: f32) -> Result<Particles> {
    let len = places.len();
    let mut discs = Particles::try_new(
        places,
        memory::filled(len, [0.0; 2])?,
        memory::filled(len, radius)?,
        1.0,
    )?;
    discs.movable.fill(false);
    Ok(discs)
}

/// Random positions in `area`, one for each radius, without overlap unless [`TRIES`] attempts fail.
/// Larger discs are placed first. Discs of similar size have a grid of their own, and each disc is
/// tested against the grids of its own size and of larger sizes.
pub(crate) fn scatter(radii: &[f32], area: Area, random: &mut Random) -> Result<Vec<[f32; 2]>> {
    let mut by_size = memory::collect(0..radii.len())?;
    // Large discs find no place any more among many small ones. Equal radii keep the order of
    // rows.
    by_size.sort_unstable_by(|&a, &b| radii[b].total_cmp(&radii[a]).then(a.cmp(&b)));
    let mut places = memory::filled(radii.len(), [0.0; 2])?;
    let mut grids: Vec<Grid> = Vec::new();
    for index in by_size {
        let radius = radii[index];
        // Sizes within a factor of two share a grid. With one grid for all, cells as wide as the
        // largest disc would contain thousands of the smallest ones.
        if grids.last().is_none_or(|grid| radius < grid.largest / 2.0) {
            grids.push(Grid { largest: radius, cells: HashMap::new() });
        }
        let mut try_place = || {
            let along =
                |k: usize, u: f32| area[k] + radius + u * (area[k + 2] - area[k] - 2.0 * radius);
            [along(0, random.unit()), along(1, random.unit())]
        };
        let mut place = try_place();
        for _ in 0..TRIES {
            if grids.iter().all(|grid| grid.is_free(place, radius, &places, radii)) {
                break;
            }
            place = try_place();
        }
        places[index] = place;
        if let Some(grid) = grids.last_mut() {
            grid.put(place, index)?;
        }
    }
    Ok(places)
}

/// A uniform grid of discs of similar size; cells are as wide as the largest disc.
struct Grid {
    largest: f32,
    cells: HashMap<(i32, i32), Vec<usize>>,
}

impl Grid {
    fn cell(&self, place: [f32; 2]) -> (i32, i32) {
        // Two discs of this grid overlap only if their cells are neighbours; a smaller one that is
        // tested here, too.
        let side = 2.0 * self.largest;
        ((place[0] / side).floor() as i32, (place[1] / side).floor() as i32)
    }

    fn put(&mut self, place: [f32; 2], index: usize) -> Result<()> {
        type Cell = ((i32, i32), Vec<usize>);
        let len = self.cells.len() + 1;
        self.cells.try_reserve(1).map_err(|error| memory::no_memory::<Cell>(&error, len))?;
        memory::push(self.cells.entry(self.cell(place)).or_default(), index)
    }

    fn is_free(&self, place: [f32; 2], radius: f32, places: &[[f32; 2]], radii: &[f32]) -> bool {
        let (x, y) = self.cell(place);
        let around =
            (y - 1..=y + 1).flat_map(|row| (x - 1..=x + 1).map(move |column| (column, row)));
        around.filter_map(|cell| self.cells.get(&cell)).flatten().all(|&other| {
            let offset = [0, 1].map(|k| places[other][k] - place[k]);
            let radius_sum = radii[other] + radius;
            offset[0] * offset[0] + offset[1] * offset[1] >= radius_sum * radius_sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_is_smooth_and_ends_where_it_should() {
        let (start, end) = ([3.0, -4.0], [-60.0, 70.0]);
        let distance = |a: [f32; 2], b: [f32; 2]| {
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            (x * x + y * y).sqrt()
        };
        let beads = wall(start, end, 2.5).unwrap();
        assert_eq!((beads[0], beads[beads.len() - 1]), (start, end));
        assert!(beads.windows(2).all(|pair| distance(pair[0], pair[1]) <= 1.0001));
        let longer = distance(start, end) + 2.0;
        assert!((beads.len() as f32) < longer, "{} beads are too many", beads.len());
        assert_eq!(wall(start, start, 1.0).unwrap(), [start]);
    }
}
