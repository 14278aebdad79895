//! x
use leastaction_core::energy::trigonometric::*;
use leastaction_core::forces::*;
use leastaction_firmware_sim::scenario::*;
use leastaction_firmware_sim::devices::*;
use core::f32::consts::PI;
type Inertia<const N: usize> = Vec<(usize, usize, Wave<N>)>;
fn perturbed<const N: usize>(t: &Trigonometric<'static, N>, seed: u64, size: f64, x: f64) -> (Inertia<N>, Vec<Wave<N>>) {
    let mut s = Stream::new(seed ^ 0xabcdef, Device::Start);
    let mut inertia = t.inertia.to_vec();
    let mut potential = t.potential.to_vec();
    for (_, _, w) in &mut inertia { w.amplitude *= 1.0 + size * f64::from(s.symmetric()).signum(); }
    for w in &mut potential { w.amplitude *= 1.0 + size * f64::from(s.symmetric()).signum(); }
    if x > 0.0 {
        let mut k = [0.0; N]; k[0] = 1.3;
        potential.push(Wave{amplitude: x, wave: k});
        let mut k = [1.0; N]; k[0] = -0.9;
        potential.push(Wave{amplitude: x, wave: k});
        for (i, j, w) in &t.inertia.to_vec() { inertia.push((*i,*j,Wave{amplitude: 0.03*w.amplitude, wave: k})); }
    }
    (inertia, potential)
}
fn stats(name: &str, r: Vec<(bool, Option<f32>, f32, u32)>) {
    let n = r.len(); let ok = r.iter().filter(|r| r.0).count();
    let mut t: Vec<f32> = r.iter().filter_map(|r| if r.0 {r.1} else {None}).collect(); t.sort_by(f32::total_cmp);
    let mx = r.iter().map(|r| r.2).fold(0.0, f32::max);
    println!("{name:40} {ok}/{n} median {:?} max {:?} maxq {mx} errs {}", t.get(t.len()/2), t.last(), r.iter().map(|r| r.3).sum::<u32>());
}
#[test]
fn explore() {
    let variants: [(&str, fn(&mut Devices<1>), fn(&mut Devices<2>)); 5] = [
        ("plain", |_| {}, |_| {}),
        ("drop10", |d| d.encoders.iter_mut().for_each(|e| e.drop = 0.1), |d| d.encoders.iter_mut().for_each(|e| e.drop = 0.1)),
        ("drop50", |d| d.encoders.iter_mut().for_each(|e| e.drop = 0.5), |d| d.encoders.iter_mut().for_each(|e| e.drop = 0.5)),
        ("late20 missed5", |d| d.clock = ClockConfig{late:0.2,jitter:0.5,missed:0.05}, |d| d.clock = ClockConfig{late:0.2,jitter:0.5,missed:0.05}),
        ("noise x5", |d| d.encoders.iter_mut().for_each(|e| e.noise *= 5.0), |d| d.encoders.iter_mut().for_each(|e| e.noise *= 5.0)),
    ];
    let p = System::conservative(PENDULUM);
    let c = System::conservative(CARTPOLE);
    for wide in [false, true] { for tick in [0.01, 0.02] { for delay in [1u8, 2] { for (size, x) in [(0.0, 0.0), (0.05, 0.0), (0.05, 0.01), (0.1, 0.03)] {
        for (name, v1, v2) in &variants {
            let mut r = vec![]; let mut rc = vec![];
            for seed in 0..60 {
                let (i, v) = perturbed(&PENDULUM, seed, size, 0.0);
                let m = System::conservative(Trigonometric{inertia:&i, potential:&v});
                let mut cfg = SwingUpConfig::pendulum();
                cfg.setup.seed = seed; cfg.setup.tick = tick; v1(&mut cfg.setup.devices);
                cfg.setup.devices.actuator.delay = delay; cfg.setup.observer.delay = delay;
                if wide { cfg.setup.start.q_spread = [PI]; cfg.setup.start.v_spread = [3.0]; }
                let s = swing_up_pendulum(&p, &m, &cfg, |_| {}).unwrap();
                r.push((s.success, s.settled_at, s.max_q[0], s.incidents.model));
                let (i, v) = perturbed(&CARTPOLE, seed, size, x);
                let m = System::conservative(Trigonometric{inertia:&i, potential:&v});
                let mut cfg = SwingUpConfig::cartpole();
                cfg.setup.seed = seed; cfg.setup.tick = tick; v2(&mut cfg.setup.devices);
                cfg.setup.devices.actuator.delay = delay; cfg.setup.observer.delay = delay;
                if wide { cfg.setup.start.q_spread = [0.5, PI]; cfg.setup.start.v_spread = [0.3,3.0]; }
                let s = swing_up_cartpole(&c, &m, &cfg, |_| {}).unwrap();
                rc.push((s.success, s.settled_at, s.max_q[0], s.incidents.model));
            }
            let id = format!("wide {wide} h {tick} d {delay} pert {size} {x} {name}");
            stats(&format!("P {id}"), r); stats(&format!("C {id}"), rc);
        }
    }}}}
}
