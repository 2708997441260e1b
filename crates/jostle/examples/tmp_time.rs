use jostle::*;
use std::time::Instant;
fn main(){
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let cap: usize = std::env::args().nth(2).unwrap().parse().unwrap();
    let mut s=12345u64; let mut rnd=||{ s^=s<<13; s^=s>>7; s^=s<<17; (s>>40) as f32/(1u64<<24) as f32};
    let side=(n as f32*std::f32::consts::PI*0.25/0.4).sqrt();
    let x:Vec<f32>=(0..n).map(|_|rnd()*side).collect(); let y:Vec<f32>=(0..n).map(|_|rnd()*side).collect();
    let c=Columns::new(x,y,vec![0.5;n],None,None).unwrap();
    let set=Settings{leaf_capacity:cap,threads:Some(1),..Default::default()};
    for _ in 0..5 {
        let t0=Instant::now(); let t=Quadtree::new(&c,set).unwrap(); let t1=Instant::now();
        let f=pairs::within(&t,1<<27).unwrap(); let t2=Instant::now();
        println!("build {:.1} ns join {:.1} ns pairs {} tests/shape {:.1} leaves {}", (t1-t0).as_nanos() as f64/n as f64,(t2-t1).as_nanos() as f64/n as f64,f.pairs.len(), f.tests as f64/n as f64, t.leaf_count());
        if n<=20000 { let b=pairs::brute(&c,Some(1),1<<27).unwrap(); let mut f=f; f.sort(); assert_eq!(f.pairs,b.pairs); t.check().unwrap(); }
    }
}
