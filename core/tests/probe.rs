//! temporary
mod common;
use leastaction_core::continuous;
use leastaction_core::discrete::*;
use leastaction_core::energy::trigonometric::*;
use leastaction_core::forces::*;
use leastaction_core::linear;
use leastaction_core::scalar::*;

fn drift<P: Path, const N: usize>(name: &str, sys: Trigonometric<'static, N>, q: [f32; N], v: [f32; N], h: f32, newton: Newton<f32>) {
    let system = System::conservative(sys);
    let del = Del::<f32, P>::with_newton(h, newton);
    let mut s = State::new(&sys, q, v).unwrap();
    let energy = |s: &State<f32, N>| {
        let q = s.q().map(f64::from); let p = s.p().map(f64::from);
        let v = linear::solve(sys.mass_matrix(&q), p).unwrap();
        continuous::energy(&sys, &q, &v)
    };
    let e0 = energy(&s);
    let mut es = vec![];
    let n = 1_000_000;
    for k in 0..n {
        if k % 50 == 0 { es.push(energy(&s) - e0); }
        del.step(&system, &mut s, &Control::none()).unwrap();
    }
    let m = es.len() as f64;
    let (mx, my) = ((m - 1.0) / 2.0, es.iter().sum::<f64>() / m);
    let slope = es.iter().enumerate().map(|(i, e)| (i as f64 - mx) * (e - my)).sum::<f64>() / es.iter().enumerate().map(|(i, _)| (i as f64 - mx).powi(2)).sum::<f64>();
    let resid: Vec<f64> = es.iter().enumerate().map(|(i, e)| e - my - slope * (i as f64 - mx)).collect();
    let max = resid.iter().fold(f64::MIN, |a, b| a.max(*b)); let min = resid.iter().fold(f64::MAX, |a, b| a.min(*b));
    println!("{name} order {} h {h}: e0 {e0:.3} drift over run {:.3e} oscillation {:.3e} mean {my:.2e} q {:?}", P::ORDER, slope * m, (max - min) / 2.0, s.q());
}
#[test]
fn a() {
    let d = Newton::default();
    for newton in [d, Newton { stop: 0.25 * f32::EPSILON, ..d }, Newton { max_iterations: 3, stop: 0.0, ..d }] {
        println!("Newton {newton:?}");
    for h in [0.01f32, 0.05] {
        for q in [0.5f32, 1.7] {
        drift::<Midpoint, 1>("pend", PENDULUM, [q], [0.3], h, newton);
        drift::<Galerkin, 1>("pend", PENDULUM, [q], [0.3], h, newton);
        drift::<Midpoint, 2>("cart", CARTPOLE, [0.0, q], [0.0, 0.3], h, newton);
        drift::<Galerkin, 2>("cart", CARTPOLE, [0.0, q], [0.0, 0.3], h, newton);
    }}}
}
fn gap<P: Path, const N: usize>(name: &str, sys: Trigonometric<'static, N>, q: [f32; N], v: [f32; N], h: f32) {
    let s32 = System::conservative(sys); let s64 = System::conservative(sys);
    for (what, h64) in [("same h", f64::from(h)), ("true h", (f64::from(h) * 1e6).round() / 1e6)] {
        let (d32, d64) = (Del::<f32, P>::new(h), Del::<f64, P>::new(h64));
        let mut a = State::new(&sys, q, v).unwrap();
        let mut b = State::new(&sys, q.map(f64::from), v.map(f64::from)).unwrap();
        let mut worst = [0f64; N];
        for _ in 0..3000 {
            d32.step(&s32, &mut a, &Control::none()).unwrap();
            d64.step(&s64, &mut b, &Control::none()).unwrap();
            for i in 0..N { worst[i] = worst[i].max((f64::from(a.q()[i]) - b.q()[i]).abs()); }
        }
        let end: Vec<f64> = (0..N).map(|i| f64::from(a.q()[i]) - b.q()[i]).collect();
        println!("{name} order {} {what} {q:?} {v:?}: end {end:?} worst {worst:?}", P::ORDER);
    }
}
#[test]
fn b() {
    for (q, v) in [(0.51f32, 0.0f32), (1.0, 0.0), (2.0, 1.0), (-2.5, 3.0), (0.1, 4.0)] {
        gap::<Midpoint, 1>("pend", PENDULUM, [q], [v], 0.001);
        gap::<Galerkin, 1>("pend", PENDULUM, [q], [v], 0.001);
        gap::<Midpoint, 2>("cart", CARTPOLE, [0.3, q], [0.05, v], 0.001);
        gap::<Galerkin, 2>("cart", CARTPOLE, [0.3, q], [0.05, v], 0.001);
    }
}
