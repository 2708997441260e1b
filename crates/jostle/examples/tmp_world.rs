use jostle::*;
use std::time::Instant;
struct R(u64); impl R{ fn f(&mut self)->f32{ self.0^=self.0<<13; self.0^=self.0>>7; self.0^=self.0<<17; (self.0>>40) as f32/(1u64<<24) as f32 } }
fn overlap(w:&World)->(f32,f32){ // max overlap / min radius, mean speed
    let p=w.particles(); let n=p.len();
    let c=Columns::new(p.positions.iter().map(|p|p[0]).collect(),p.positions.iter().map(|p|p[1]).collect(),p.radii.clone(),None,None).unwrap();
    let f=pairs::find(&c,None,Some(1),1<<27).unwrap();
    let mut m=0f32; for [a,b] in f.pairs { let (a,b)=(a as usize,b as usize); let (_,d)=geometry::contact(&c.shape(a),&c.shape(b)); m=m.max(d/p.radii[a].min(p.radii[b])); }
    let s=p.velocities.iter().map(|v|(v[0]*v[0]+v[1]*v[1]).sqrt()).sum::<f32>()/n as f32;
    (m,s)
}
fn main(){
    let what=std::env::args().nth(1).unwrap(); let n: usize = std::env::args().nth(2).unwrap().parse().unwrap(); let sub: usize=std::env::args().nth(3).unwrap().parse().unwrap();
    let steps: usize=std::env::args().nth(4).unwrap().parse().unwrap();
    let mut r=R(12345);
    if what=="pile" {
        let mut p=vec![]; let mut rad=vec![];
        let cols=36; for i in 0..n { rad.push(5.0+5.0*r.f()); p.push([20.0+(i%cols) as f32*21.5, 500.0-20.5*(i/cols) as f32]); }
        let v=vec![[0.0;2];n];
        let e: f32=std::env::args().nth(5).unwrap().parse().unwrap();
        let set=WorldSettings{gravity:[0.0,900.0],restitution:e,substeps:sub,container:Container::Box{min:[0.0,-1000.0],max:[800.0,500.0]},tree:Settings{threads:Some(1),..Default::default()},..Default::default()};
        let v: Vec<[f32;2]>=v.iter().map(|_|[40.0*(r.f()-0.5),0.0]).collect();
        let mut w=World::new(Particles::new(p,v,rad,1.0),set).unwrap();
        for s in 0..steps { let t=Instant::now(); w.step(1.0/60.0,60,&mut |_|()).unwrap(); let e=t.elapsed();
            let (o,m)=overlap(&w); println!("{}s overlap {:.2}% speed {:.3} KE {:.3} PE {:.1} step {:.3} ms contacts {}",s+1,o*100.0,m,w.kinetic_energy(),w.potential_energy(),e.as_secs_f64()*1e3/60.0,w.contacts().len()); }
    } else {
        let side=(n as f32*std::f32::consts::PI*25.0/0.4).sqrt();
        let k=(n as f32).sqrt().ceil() as usize; let d=side/k as f32;
        let p:Vec<[f32;2]>=(0..n).map(|i|[d*((i%k) as f32+0.5),d*((i/k) as f32+0.5)]).collect();
        let sp: f32=std::env::args().nth(5).unwrap().parse().unwrap();
        let v:Vec<[f32;2]>=(0..n).map(|_|[sp*(r.f()-0.5),sp*(r.f()-0.5)]).collect();
        let set=WorldSettings{substeps:sub,container:Container::Box{min:[0.0;2],max:[side;2]},tree:Settings{threads:Some(1),..Default::default()},..Default::default()};
        let mut w=World::new(Particles::new(p,v,vec![5.0;n],1.0),set).unwrap();
        let e0=w.kinetic_energy(); let mut acc=[0.0f64;5]; 
        for s in 0..steps { let t=Instant::now(); let mut last=Instant::now(); let mut hook=|st:Stage|{ acc[st as usize]+=last.elapsed().as_secs_f64(); last=Instant::now(); }; w.step(1.0/60.0,100,&mut hook).unwrap(); let el=t.elapsed();
            if s%(steps/10).max(1)==0 {let (o,_)=overlap(&w); println!("{} KE {:.8} overlap {:.1}% step {:.3} ms contacts {}",(s+1)*100,w.kinetic_energy()/e0,o*100.0,el.as_secs_f64()*1e3/100.0,w.contacts().len());} }
        println!("{:?} ns/disc/step",acc.map(|a| a*1e9/(steps*100*n) as f64));
    }
}
