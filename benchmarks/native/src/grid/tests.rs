//! Every kernel of the grid against the library's brute force, with cells of any size.

use jostle_index::{Columns, pairs};
use jostle_scenes::random::Random;

use super::CellSize;
use crate::rivals::Pair;
use crate::scenes::{SCENES, Shapes};
use crate::simd::Level;

const COUNT: usize = 1_500;

fn brute(shapes: &Shapes) -> Vec<Pair> {
    let columns = Columns::of(&shapes.rows()).expect("there is memory");
    let mut pairs = pairs::brute(&columns, Some(1), usize::MAX).expect("any number of pairs").pairs;
    pairs.sort_unstable();
    pairs
}

/// The levels of this processor.
fn levels() -> Vec<Level> {
    let all = [Level::Plain, Level::Avx2, Level::Avx512];
    all.into_iter().filter(|&level| level.is_there()).collect()
}

#[test]
fn every_kernel_finds_what_brute_force_finds() {
    for scene in &SCENES {
        let shapes = (scene.make)(COUNT, &mut Random::new(7));
        let expected = brute(&shapes);
        assert!(expected.len() > COUNT / 4, "{} has pairs to find", scene.name);
        for level in levels() {
            // Small and large cells, and one cell for all: strips of more than 256.
            for [width, height] in [[0.1, 3.0], [5.0, 1.0], [1e6, 4.0], [1e6, 1e6]] {
                for threads in [1, 2] {
                    let cell = CellSize { width, height };
                    let mut found = super::pairs(&shapes, cell, level, threads);
                    found.sort_unstable();
                    assert!(found == expected, "{}, {level:?}, {cell:?}", scene.name);
                }
            }
        }
    }
}

#[test]
fn no_shape_and_one_shape_have_no_pairs() {
    let cell = CellSize { width: 1.0, height: 1.0 };
    for count in [0, 1] {
        let line = || vec![1.0; count];
        let shapes = Shapes { x: line(), y: line(), radius: line(), ..Shapes::default() };
        assert_eq!(super::pairs(&shapes, cell, Level::best(), 1), Vec::<Pair>::new());
    }
}

#[test]
fn coincident_discs_all_pair() {
    let shapes =
        Shapes { x: vec![3.0; 40], y: vec![-3.0; 40], radius: vec![1.0; 40], ..Shapes::default() };
    let cell = CellSize { width: 1.0, height: 1.0 };
    assert_eq!(super::pairs(&shapes, cell, Level::best(), 1).len(), 40 * 39 / 2);
}
