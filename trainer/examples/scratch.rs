//! scratch
use leastaction::architecture::Architecture;
use leastaction::ground_truth::*;
use leastaction::training::*;
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mech = match a[1].as_str() { "pendulum" => Mechanism::Pendulum, "cartpole" => Mechanism::Cartpole, _ => Mechanism::Acrobot };
    let kind = if a[2] == "symo" { LossKind::DelResidual } else { LossKind::NextPosition };
    let order: u8 = a[3].parse().unwrap();
    let n: usize = a[4].parse().unwrap();
    let width: u16 = a[5].parse().unwrap();
    let iters: usize = a[6].parse().unwrap();
    let seed: u64 = a[7].parse().unwrap();
    let t = Instant::now();
    let set = symo_set(mech, 0).unwrap();
    println!("generated in {:?}", t.elapsed());
    let arch = Architecture::new(mech.coordinates(), width);
    let pre = objective(&arch, Samples::triples(&set.train.truncated(n)), LossKind::DelResidual, order).unwrap();
    let obj = objective(&arch, Samples::triples(&set.train.truncated(n)), kind, order).unwrap();
    let test = objective(&arch, Samples::triples(&set.test), LossKind::NextPosition, order).unwrap();
    let w = arch.initial_weights(seed);
    println!("parameters {} samples {}", w.len(), obj.samples());
    // gradient check
    let ne = obj.normal_equations(&w).unwrap();
    for i in [0usize, 5, w.len() - 1, w.len() / 2] {
        let d = 1e-6;
        let mut wp = w.clone(); wp[i] += d;
        let mut wm = w.clone(); wm[i] -= d;
        let fd = (obj.loss(&wp) - obj.loss(&wm)) / (2.0 * d) * ne.rows as f64 / 2.0;
        println!("  {i}: {} {}", ne.gradient[i], fd);
    }
    let t = Instant::now();
    let mut w = w;
    if kind == LossKind::NextPosition {
        let mut lm = Levenberg::new(&*pre, w);
        for _ in 0..20 { lm.iterate(&*pre); }
        w = lm.weights;
    }
    let mut lm = Levenberg::new(&*obj, w);
    for i in 0..iters {
        let p = lm.iterate(&*obj);
        if i % (iters / 20).max(1) == 0 || p != Progress::Lower {
            println!("{i} {:?} loss {:.3e} test {:.3e} {:?}", p, lm.loss, test.loss(&lm.weights), t.elapsed());
        }
        if p != Progress::Lower { break; }
    }
    println!("end loss {:.3e} test {:.3e} {:?}", lm.loss, test.loss(&lm.weights), t.elapsed());
}
