//! Runs cases from seeds until enough operations are done.

use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use jostle_index::Scalar;
use jostle_scenes::random::Random;

/// Operations of all objects together, unless the environment says otherwise.
const OPERATIONS: usize = 40_000;

/// Operations of a case at most.
const LONGEST: usize = 80;

/// An object with its model.
pub trait Case {
    fn new(draw: &mut Draw) -> Self;
    /// Makes one operation on both, and compares.
    fn operate(&mut self, draw: &mut Draw);
}

/// Runs so many of a thousand operations on objects of one kind.
pub fn run<C: Case>(of_thousand: usize) {
    let number = |name: &str| {
        let text = std::env::var(name).ok()?;
        Some(text.parse::<usize>().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
    };
    if let Some(seed) = number("JOSTLE_SEED") {
        run_case::<C>(seed as u64, true);
        return;
    }
    let wanted = number("JOSTLE_OPERATIONS").unwrap_or(OPERATIONS) * of_thousand / 1000;
    let (mut done, mut seed) = (0, 0);
    while done < wanted {
        match catch_unwind(AssertUnwindSafe(|| run_case::<C>(seed, false))) {
            Ok(operations) => done += operations,
            Err(_) => {
                eprintln!("The case with JOSTLE_SEED={seed} fails. Its operations:");
                let again = catch_unwind(AssertUnwindSafe(|| run_case::<C>(seed, true)));
                eprintln!("This was the case with JOSTLE_SEED={seed}.");
                resume_unwind(again.err().unwrap_or_else(|| Box::new("it does not fail again")));
            }
        }
        seed += 1;
    }
}

/// Returns the number of operations.
fn run_case<C: Case>(seed: u64, prints: bool) -> usize {
    let mut draw = Draw { random: Random::new(seed), prints };
    let operations = 1 + draw.below(LONGEST);
    let mut case = C::new(&mut draw);
    (0..operations).for_each(|_| case.operate(&mut draw));
    operations
}

/// Random choices. Difficult ones are frequent: equal numbers, numbers that touch exactly, numbers at borders of
/// cells, huge and tiny ones.
pub struct Draw {
    random: Random,
    prints: bool,
}

impl Draw {
    /// Prints an operation if the case is repeated.
    pub fn say(&self, name: &str, arguments: impl Debug) {
        if self.prints {
            eprintln!("  {name} {arguments:?}");
        }
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.random.whole(0, count as u32 - 1) as usize
    }

    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    pub fn pick<V: Copy>(&mut self, from: &[V]) -> V {
        from[self.below(from.len())]
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        f64::from(self.random.between(low as f32, high as f32))
    }

    /// So many values, from none to `most`: often none or one.
    pub fn some<V>(&mut self, most: usize, mut value: impl FnMut(&mut Self) -> V) -> Vec<V> {
        let most = self.pick(&[1, most, most]);
        let count = self.below(most + 1);
        (0..count).map(|_| value(self)).collect()
    }

    pub fn coordinate<T: Scalar>(&mut self) -> T {
        T::from_f64(match self.below(24) {
            0..11 => self.between(-10.0, 10.0),
            11..20 => self.below(9) as f64 - 4.0,
            20 => 0.5 * self.below(9) as f64,
            21 => 7.0 + 1e-6 * self.below(4) as f64,
            22 => self.pick(&[0.0, -0.0, 1e-30, -1e-30]),
            _ => self.pick(&[1e30, -1e30, 1e7, -1e7, 4096.0]),
        })
    }

    /// A point, often of a lattice.
    pub fn point<T: Scalar>(&mut self) -> [T; 2] {
        if self.one_in(3) {
            return [0, 1].map(|_| T::from_f64(self.below(9) as f64 - 4.0));
        }
        [self.coordinate(), self.coordinate()]
    }

    /// A radius, a half size or a distance.
    pub fn size<T: Scalar>(&mut self) -> T {
        T::from_f64(match self.below(12) {
            0..5 => self.between(0.0, 2.0),
            5..8 => self.pick(&[0.5, 1.0, 2.0]),
            8..11 => 0.0,
            _ => self.pick(&[1e-6, 30.0, 1e6]),
        })
    }

    /// Categories or a mask.
    pub fn bits(&mut self) -> u32 {
        self.pick(&[u32::MAX, u32::MAX, u32::MAX, 1, 2, 3, 0, 1 << 31])
    }

    pub fn mask(&mut self) -> Option<u32> {
        if self.one_in(3) { Some(self.bits()) } else { None }
    }

    /// Different ones of some values, in any order.
    pub fn subset<V: Copy>(&mut self, of: &[V], most: usize) -> Vec<V> {
        let mut rest = of.to_vec();
        let count = self.pick(&[1, most, most]).min(rest.len());
        let count = self.below(count + 1);
        (0..count).map(|_| rest.swap_remove(self.below(rest.len()))).collect()
    }

    /// A number that no argument may be.
    pub fn wrong<T: Scalar>(&mut self) -> T {
        T::from_f64(self.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]))
    }
}
