use jostle::*;
use std::time::Instant;
fn rnd(s: &mut u64) -> f64 {
    *s ^= *s << 13;
    *s ^= *s >> 7;
    *s ^= *s << 17;
    (*s >> 11) as f64 / (1u64 << 53) as f64
}
fn run(name: &str, shapes: &Shapes<f64>, rules: &Separation<f64>) -> Vec<[f64; 2]> {
    let mut best = f64::MAX;
    let mut out = Separated::default();
    for _ in 0..5 {
        let t = Instant::now();
        out = separate(shapes, rules).unwrap();
        best = best.min(t.elapsed().as_secs_f64());
        if best > 1.0 {
            break;
        }
    }
    let moved: f64 = out
        .centers
        .iter()
        .zip(&shapes.centers)
        .map(|(a, b)| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt())
        .sum::<f64>()
        / shapes.len() as f64;
    let after = Shapes { centers: out.centers.clone(), ..shapes.clone() };
    let left = pairs::find(&after, None, None, 1 << 27).unwrap().pairs.len();
    let before = pairs::find(shapes, None, None, 1 << 27).map(|f| f.pairs.len()).unwrap_or(0);
    println!(
        "{name}: {:.2} ms, rounds {}, overlaps {} (check {left}) of {before}, mean move {moved:.3}",
        best * 1e3,
        out.rounds,
        out.overlaps
    );
    out.centers
}
fn main() {
    let mut s = 88172645463325252u64;
    let n = 10_000;
    for threads in [Some(1), None] {
        for fill in [0.3, 0.5, 0.6, 0.7, 0.8] {
            // equal discs radius 1, first separated, then jittered by 5 %
            let side = (n as f64 * std::f64::consts::PI / fill).sqrt();
            let c: Vec<[f64; 2]> =
                (0..n).map(|_| [rnd(&mut s) * side, rnd(&mut s) * side]).collect();
            let shapes = Shapes::circles(c, Each::One(1.0)).unwrap();
            let rules = Separation { threads, ..Default::default() };
            let apart = run(&format!("random {fill}"), &shapes, &rules);
            let j: Vec<[f64; 2]> = apart
                .iter()
                .map(|c| [c[0] + 0.2 * (rnd(&mut s) - 0.5), c[1] + 0.2 * (rnd(&mut s) - 0.5)])
                .collect();
            let shapes = Shapes::circles(j, Each::One(1.0)).unwrap();
            run(&format!("  jittered {fill}"), &shapes, &rules);
        }
    }
    let rules = Separation::default();
    for spread in [0.0, 100.0, 1000.0] {
        let g = |s: &mut u64| (0..6).map(|_| rnd(s) - 0.5).sum::<f64>();
        let c: Vec<[f64; 2]> = (0..n).map(|_| [g(&mut s) * spread, g(&mut s) * spread]).collect();
        let h: Vec<[f64; 2]> = (0..n).map(|_| [15.0 + 30.0 * rnd(&mut s), 6.0]).collect();
        let labels = Shapes::new(c.clone(), Each::One(0.0), Some(Each::Rows(h)), None).unwrap();
        run(&format!("labels heap {spread}"), &labels, &rules);
        let r: Vec<f64> = (0..n).map(|_| 1.0 + 9.0 * rnd(&mut s)).collect();
        run(&format!("bubbles heap {spread}"), &Shapes::circles(c, Each::Rows(r)).unwrap(), &rules);
    }
    let c: Vec<[f64; 2]> =
        (0..n).map(|_| [(0..6).map(|_| rnd(&mut s) - 0.5).sum::<f64>() * 300.0, 0.0]).collect();
    run(
        "beeswarm",
        &Shapes::circles(c, Each::One(2.0)).unwrap(),
        &Separation { axis: Some(1), ..Default::default() },
    );
    let c: Vec<[f64; 2]> = (0..200).map(|_| [rnd(&mut s) * 1000.0, 0.0]).collect();
    run(
        "timeline",
        &Shapes::new(c, Each::One(0.0), Some(Each::One([10.0, 5.0])), None).unwrap(),
        &Separation { axis: Some(0), ..Default::default() },
    );
}
