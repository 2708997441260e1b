//! The first root of a polynomial in an interval, by subdivision in the Bernstein basis (J. M. Lane and
//! R. F. Riesenfeld, *Bounds on a Polynomial*, BIT 21, 1981) and Newton's method.

/// Highest degree plus one.
const TERMS: usize = 5;

/// Halvings after which an interval counts as a point. Near 1, float64 resolves only 5 more.
const MOST_HALVINGS: i32 = 48;

/// Iterations of Newton's method within a bracket.
const MOST_ITERATIONS: usize = 64;

/// The first t in [0, `span`] at which Σ `coefficients[k]` · tᵏ is 0 or less. The polynomial has
/// at most degree 4.
///
/// The polynomial is written in the Bernstein basis, where it lies between its smallest and its
/// largest coefficient: an interval in which all are above 0 has no root. Other intervals are
/// halved, the earlier half first, until their coefficients change sign once. Then they have one
/// root, which Newton's method finds, with bisection where it would leave the interval.
pub fn first_root(coefficients: [f64; TERMS], span: f64) -> Option<f64> {
    // The interval is scaled to [0, 1], where the conversion to the Bernstein basis has constant
    // factors. Scaling by products keeps the order of operations fixed.
    let mut power = coefficients;
    let mut scale = 1.0;
    for term in &mut power {
        *term *= scale;
        scale *= span;
    }
    // The surfaces touch or overlap at the start. Callers treat this case first where it means
    // something else.
    if power[0] <= 0.0 {
        return Some(0.0);
    }
    // Intervals still to be searched, the earliest on top; at most one a level.
    // A stack of fixed size instead of recursion: no allocation, and the depth is bounded by the
    // number of halvings.
    let mut stack = [(0.0, 1.0, [0.0; TERMS]); MOST_HALVINGS as usize + 2];
    stack[0].2 = bernstein(power);
    let mut open = 1;
    let shortest = 0.5f64.powi(MOST_HALVINGS);
    while open > 0 {
        open -= 1;
        let (low, high, terms) = stack[open];
        // The polynomial is a mean of its Bernstein coefficients with positive weights. If all are
        // positive, it has no root here. This is what makes the search complete: no root is
        // skipped, unlike with Newton's method alone.
        if terms.iter().all(|&term| term > 0.0) {
            continue;
        }
        // Finite numbers have a first term above 0 here, NaN does not.
        if high - low <= shortest || terms[0].is_nan() || terms[0] <= 0.0 {
            return Some(low * span);
        }
        // The number of roots is at most the number of changes of sign, and the difference is even
        // (Descartes' rule in this basis). One change means one root.
        let changes = terms.windows(2).filter(|two| (two[0] > 0.0) != (two[1] > 0.0)).count();
        if changes == 1 {
            return Some(bracketed(power, low, high) * span);
        }
        let (first, second) = halved(terms);
        let middle = 0.5 * (low + high);
        // The later half is pushed first, so that the earlier one is searched next. The first root
        // found is the first one.
        stack[open] = (middle, high, second);
        stack[open + 1] = (low, middle, first);
        open += 2;
    }
    None
}

/// Coefficients of the Bernstein basis of degree 4 on [0, 1].
fn bernstein([a, b, c, d, e]: [f64; TERMS]) -> [f64; TERMS] {
    [a, a + b / 4.0, a + b / 2.0 + c / 6.0, a + b * 0.75 + c / 2.0 + d / 4.0, a + b + c + d + e]
}

/// The coefficients on both halves of the interval (de Casteljau).
fn halved(terms: [f64; TERMS]) -> ([f64; TERMS], [f64; TERMS]) {
    let (mut first, mut second) = (terms, terms);
    // Only means of two numbers: they lie between these, so errors do not grow from level to level
    // as powers of t would.
    for (level, end) in first.iter_mut().enumerate().skip(1) {
        for k in 0..TERMS - level {
            second[k] = 0.5 * (second[k] + second[k + 1]);
        }
        *end = second[0];
    }
    (first, second)
}

/// The only root between `low`, where the polynomial is positive, and `high`.
fn bracketed(power: [f64; TERMS], mut low: f64, mut high: f64) -> f64 {
    // Newton's method from the original coefficients, not from those that were halved many times:
    // the root has the accuracy of the polynomial.
    let mut t = 0.5 * (low + high);
    for _ in 0..MOST_ITERATIONS {
        let [mut value, mut slope] = [power[TERMS - 1], 0.0];
        // Horner's scheme for value and slope, as separate products and sums: a fused multiply-add
        // would give other bits on other processors.
        for k in (0..TERMS - 1).rev() {
            slope = slope * t + value;
            value = value * t + power[k];
        }
        // The bracket shrinks in each iteration. So the method ends also where the slope is 0 or
        // the tangent points outside.
        if value > 0.0 {
            low = t;
        } else {
            high = t;
        }
        let next = t - value / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        // No number of float64 lies between any more.
        if next == t || next == low || next == high {
            break;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_roots(roots: [f64; 4], factor: f64) -> [f64; TERMS] {
        let mut terms = [factor, 0.0, 0.0, 0.0, 0.0];
        for root in roots {
            for k in (0..TERMS).rev() {
                terms[k] = if k > 0 { terms[k - 1] } else { 0.0 } - root * terms[k];
            }
        }
        terms
    }

    #[test]
    fn the_first_of_four_roots_is_found() {
        let roots = [0.3, 0.4, 0.7, 2.5];
        let found = first_root(with_roots(roots, 1.0), 1.0).unwrap();
        assert!((found - 0.3).abs() < 1e-12, "{found}");
        let found = first_root(with_roots([-0.3, 0.9, 1.7, 5.0], -1.0), 4.0).unwrap();
        assert!((found - 0.9).abs() < 1e-12, "{found}");
    }

    #[test]
    fn there_is_none_outside_the_interval() {
        assert_eq!(first_root(with_roots([1.2, 1.4, -1.0, -2.0], 1.0), 1.0), None);
        assert_eq!(first_root([1.0, 0.0, 0.0, 0.0, 0.0], 1.0), None);
        assert_eq!(first_root([1.0, -0.9, 0.0, 0.0, 0.0], 1.0), None);
        let found = first_root([1.0, -2.0, 0.0, 0.0, 0.0], 1.0).unwrap();
        assert!((found - 0.5).abs() < 1e-15, "{found}");
    }

    #[test]
    fn a_double_root_is_found_to_rounding_or_not_at_all() {
        if let Some(found) = first_root(with_roots([0.5, 0.5, -1.0, 3.0], -1.0), 1.0) {
            assert!((found - 0.5).abs() < 1e-6, "{found}");
        }
    }
}
