//! `separate` against brute force and its promises, for shapes made to break it.

use jostle_index::geometry::{Shape, overlap};
use jostle_index::{Each, Scalar, Shapes};
use jostle_separate::{Separated, Separation, separate};
use proptest::prelude::*;

/// x, y, radius, half width, half height, weight, whether it is fixed.
type Row = ([f64; 2], f64, [f64; 2], f64, bool);

fn rows() -> impl Strategy<Value = Vec<Row>> {
    let coordinate =
        prop_oneof![6 => -20.0..20.0f64, 3 => (-4i32..4).prop_map(f64::from), 1 => Just(0.0)];
    let size = prop_oneof![5 => 0.1..3.0f64, 2 => Just(1.0), 1 => Just(0.0), 1 => Just(9.0)];
    let half = prop_oneof![Just([0.0; 2]).boxed(), [size.clone(), size.clone()].boxed()];
    let weight = prop_oneof![3 => Just(1.0), 1 => 0.1..9.0f64];
    let row = ([coordinate.clone(), coordinate], size, half, weight, prop::bool::weighted(0.1));
    prop::collection::vec(row, 0..70)
}

fn rules<T: Scalar>() -> impl Strategy<Value = Separation<T>> {
    let bounds = prop_oneof![2 => Just(None), 1 => Just(Some([-30.0, -25.0, 30.0, 25.0]))];
    let axis = prop_oneof![2 => Just(None), 1 => Just(Some(0)), 1 => Just(Some(1))];
    let rounds = prop_oneof![3 => Just(1000usize), 1 => 0usize..20];
    let gap = prop_oneof![2 => Just(0.0), 1 => Just(0.5)];
    (bounds, axis, rounds, gap).prop_map(|(bounds, axis, max_rounds, gap)| Separation {
        bounds: bounds.map(|bounds: [f64; 4]| bounds.map(T::from_f64)),
        axis,
        max_rounds,
        gap: T::from_f64(gap),
        threads: Some(1),
        ..Separation::default()
    })
}

fn shapes<T: Scalar>(rows: &[Row]) -> Shapes<T> {
    let pair = |v: [f64; 2]| v.map(T::from_f64);
    let centers = rows.iter().map(|row| pair(row.0)).collect();
    let radii = Each::Rows(rows.iter().map(|row| T::from_f64(row.1)).collect());
    let halves = Each::Rows(rows.iter().map(|row| pair(row.2)).collect());
    Shapes::new(centers, radii, Some(halves), None).unwrap()
}

fn run<T: Scalar>(rows: &[Row], rules: &Separation<T>) -> Separated<T> {
    let rules = Separation {
        weights: Each::Rows(rows.iter().map(|row| T::from_f64(row.3)).collect()),
        movable: Each::Rows(rows.iter().map(|row| !row.4).collect()),
        ..rules.clone()
    };
    separate(&shapes(rows), &rules).unwrap()
}

/// Number of pairs that overlap, apart from those of two fixed shapes.
fn overlaps<T: Scalar>(rows: &[Row], centers: &[[T; 2]], gap: T) -> usize {
    let mut all: Shapes<T> = shapes(rows);
    *all.columns_mut().centers = centers.to_vec();
    let of_two = |a: Shape<T>, b: Shape<T>| {
        let along = |k: usize| (b.min[k] - a.min[k]).abs() - (a.half_size[k] + b.half_size[k]);
        overlap([along(0), along(1)], a.radius + b.radius + gap)
    };
    let pairs = (0..rows.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    pairs.filter(|&(i, j)| !(rows[i].4 && rows[j].4) && of_two(all.shape(i), all.shape(j))).count()
}

fn check<T: Scalar>(rows: &[Row], rules: &Separation<T>) -> Result<(), TestCaseError> {
    let apart = run(rows, rules);
    prop_assert_eq!(apart.overlaps, overlaps(rows, &apart.centers, rules.gap));
    prop_assert!(apart.rounds <= rules.max_rounds);
    for ((row, new), old) in rows.iter().zip(&apart.centers).zip(shapes::<T>(rows).centers()) {
        let is_still = row.4 || rules.max_rounds == 0;
        for axis in 0..2 {
            if is_still || rules.axis.is_some_and(|only| only != axis) {
                prop_assert_eq!(new[axis], old[axis]);
            } else if let Some(bounds) = rules.bounds {
                let extent = T::from_f64(row.1) + T::from_f64(row.2[axis]);
                prop_assert!(bounds[axis] + extent <= new[axis]);
                prop_assert!(new[axis] <= bounds[axis + 2] - extent);
            }
        }
    }
    // With room and time all succeed, unless fixed shapes enclose them along an axis.
    if rules.max_rounds == 1000 && rules.bounds.is_none() {
        prop_assert_eq!(apart.overlaps, 0);
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::common::cases(100))]

    #[test]
    fn separated_shapes_keep_the_rules(rows in rows(), rules in rules::<f64>()) {
        check(&rows, &rules)?;
    }

    #[test]
    fn separated_shapes_keep_the_rules_in_single_precision(rows in rows(), rules in rules::<f32>()) {
        check(&rows, &rules)?;
    }

    #[test]
    fn the_order_and_threads_change_nothing(
        rows in rows(), rules in rules::<f64>(), seed in any::<u64>(),
    ) {
        // Shapes with equal values at one place are exchanged by a permutation.
        let mut rows = rows;
        rows.iter_mut().zip(0..).for_each(|(row, k)| row.3 += f64::from(k) * 1e-3);
        let mut order: Vec<usize> = (0..rows.len()).collect();
        let mut state = seed | 1;
        for k in (1..order.len()).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            order.swap(k, (state >> 33) as usize % (k + 1));
        }
        let permuted: Vec<Row> = order.iter().map(|&row| rows[row]).collect();
        let one = run(&rows, &rules);
        let other = run(&permuted, &Separation { threads: Some(2), ..rules });
        for (at, &row) in order.iter().enumerate() {
            prop_assert_eq!(one.centers[row], other.centers[at]);
        }
        prop_assert_eq!((one.rounds, one.overlaps), (other.rounds, other.overlaps));
    }
}
