//! Dry friction that sticks in steps with rods: rest to the last bit, energy, the law itself by an oracle, and order.

use crate::common::particles::{Exact, hanging, rod_error, rods, rounded};
use crate::common::{Random, log_log_slope};
use leastaction_core::constraints::{Constrained, ConstraintError, Holonomic};
use leastaction_core::discrete::Order;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::forces::Grip;
use leastaction_core::particles::{Gripped, Particles};
use leastaction_core::scalar::Real;

type Vectors = Vec<[f64; 2]>;

/// Nodes on a table with dry friction: no potential, and pushes from outside.
#[derive(Clone, Debug)]
struct Table {
    masses: Vec<f64>,
    grips: Vec<[Grip<f64>; 2]>,
    constraints: Vec<Holonomic<f64, 2>>,
    start: (Vectors, Vectors),
    h: f64,
}

fn grip(level: f64) -> Grip<f64> {
    Grip { forward: level, backward: level, breakaway: 1.0 }
}

fn constraint<R: Real>(of: &Holonomic<f64, 2>) -> Holonomic<R, 2> {
    match *of {
        Holonomic::Rod { nodes, length } => Holonomic::Rod { nodes, length: R::constant(length) },
        Holonomic::Anchor { node, to, length } => {
            Holonomic::Anchor { node, to: to.map(R::constant), length: R::constant(length) }
        }
        Holonomic::Held { node, axis, at } => Holonomic::Held { node, axis, at: R::constant(at) },
    }
}

impl Table {
    /// Takes steps, before each of which `push` gives the force from the state; `look` sees the numbers of the state after each.
    fn run<R: Real>(
        &self,
        steps: usize,
        mut push: impl FnMut(usize) -> Vectors,
        mut look: impl FnMut(usize, &[R], &ParticleState<R, 2>),
    ) -> Result<(), ConstraintError<R>> {
        let system = Exact::<R, 2>::under_gravity(&self.masses, 0.0);
        let level = |g: &Grip<f64>| Grip {
            forward: R::constant(g.forward),
            backward: R::constant(g.backward),
            breakaway: R::constant(g.breakaway),
        };
        let grips: Vec<_> = self.grips.iter().map(|axes| axes.each_ref().map(level)).collect();
        let system = Gripped::new(&system, &grips, R::constant(0.01))?;
        let constraints: Vec<_> = self.constraints.iter().map(constraint).collect();
        let mechanism = Constrained::new(&system, &constraints[..])?;
        let (nodes, equations) = (self.masses.len(), constraints.len());
        let mut memory = vec![R::zero(); ParticleState::<R, 2>::workspace(nodes, equations)];
        let mut work = vec![R::zero(); Rattle::workspace(&mechanism)];
        let (q, v) = (rounded(&self.start.0), rounded(&self.start.1));
        let mut state = ParticleState::new(&mechanism, &q, &v, &mut memory, &mut work)?;
        let rattle = Rattle::new(R::constant(self.h), Order::Two);
        let mut numbers = vec![R::zero(); ParticleState::<R, 2>::saved(nodes, equations)];
        for k in 0..steps {
            let force: Vec<[R; 2]> = rounded(&push(k));
            rattle.step(&mechanism, &mut state, Some(&force), &mut work)?;
            state.save(&mut numbers)?;
            look(k, &numbers, &state);
        }
        Ok(())
    }

    fn kinetic<R: Real>(&self, state: &ParticleState<R, 2>) -> f64 {
        let energy = |(p, m): (&[R; 2], &f64)| p.map(|p| p.to_f64() * p.to_f64() / m).iter().sum::<f64>();
        state.p().iter().zip(&self.masses).map(energy).sum::<f64>() / 2.0
    }

    fn unpushed(&self) -> impl FnMut(usize) -> Vectors + use<> {
        let nodes = self.masses.len();
        move |_| vec![[0.0; 2]; nodes]
    }
}

fn bits<R: Real>(numbers: &[R]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_f64().to_bits()).collect()
}

/// A mass on a rod about the origin slides, stops, and keeps every bit of its state.
#[test]
fn a_mass_on_a_rod_stops_and_stays() {
    fn check<R: Real>() {
        let start = hanging(&[0.8], &[0.6], &[3.0]);
        let table = Table {
            masses: vec![1.3],
            grips: vec![[grip(0.9), Grip { forward: 0.5, backward: 0.7, breakaway: 1.2 }]],
            constraints: rods(&[0.8], true),
            start,
            h: 1e-3,
        };
        let (mut stopped, mut last) = (None, f64::INFINITY);
        table
            .run::<R>(14_000, table.unpushed(), |k, numbers, state| {
                let now = table.kinetic(state);
                assert!(now <= last, "step {k}: {now} J after {last} J");
                last = now;
                if k >= 4_000 {
                    let stopped = stopped.get_or_insert_with(|| bits(numbers));
                    assert_eq!(&bits(numbers), stopped, "step {k}");
                    assert!(state.p() == [[R::zero(); 2]] && state.v() == [[R::zero(); 2]]);
                }
            })
            .unwrap();
    }
    check::<f32>();
    check::<f64>();
}

/// A pushed rod, of which one node sticks, turns about it.
#[test]
fn a_rod_turns_about_the_node_that_sticks() {
    fn check<R: Real>() {
        let table = Table {
            masses: vec![1.0, 0.5],
            grips: vec![[grip(9.0); 2], [grip(0.2); 2]],
            constraints: rods(&[0.7], false),
            start: (vec![[0.1, 0.2], [0.8, 0.2]], vec![[0.0; 2]; 2]),
            h: 2e-3,
        };
        let mut turned = 0.0;
        let push = |_| vec![[0.0; 2], [0.3, 1.5]];
        table
            .run::<R>(700, push, |k, _, state| {
                assert_eq!(state.q()[0], [0.1, 0.2].map(R::constant), "step {k}");
                assert_eq!(state.v()[0], [R::zero(); 2]);
                assert!(rod_error(&table.constraints, &exact(state.q())) < 1e-6);
                turned = (state.q()[1][1] - state.q()[0][1])
                    .to_f64()
                    .atan2((state.q()[1][0] - state.q()[0][0]).to_f64());
            })
            .unwrap();
        assert!(turned > 1.0, "{turned} rad");
    }
    check::<f32>();
    check::<f64>();
}

fn exact<R: Real>(x: &[[R; 2]]) -> Vectors {
    x.iter().map(|x| x.map(R::to_f64)).collect()
}

/// Two nodes that are pushed apart rest as long as friction holds what the rod does not.
#[test]
fn a_rod_under_tension_rests() {
    fn moved<R: Real>(pushes: [f64; 2]) -> f64 {
        let table = Table {
            masses: vec![1.0, 2.0],
            grips: vec![[grip(1.0); 2]; 2],
            constraints: rods(&[0.5], false),
            start: (vec![[0.0, 0.1], [0.5, 0.1]], vec![[0.0; 2]; 2]),
            h: 1e-2,
        };
        let (mut end, mut first) = (0.0, None);
        table
            .run::<R>(
                200,
                |_| pushes.map(|f| [f, 0.0]).to_vec(),
                |k, numbers, state| {
                    let first = first.get_or_insert_with(|| bits(numbers));
                    if pushes[0] + pushes[1] < 2.0 {
                        assert_eq!(&bits(numbers), first, "step {k}");
                    }
                    end = state.q()[0][0].to_f64();
                },
            )
            .unwrap();
        end
    }
    for pushes in [[-10.0, 10.0], [-10.0, 9.5], [-9.0, 10.7], [-0.5, 0.5], [10.0, -8.1]] {
        assert_eq!([moved::<f32>(pushes), moved::<f64>(pushes)], [0.0; 2], "{pushes:?}");
    }
    // (12.1 − 10 − 2) N on 3 kg for 2 s, where each step's momentum is that of its middle.
    for end in [moved::<f32>([-10.0, 12.1]), moved::<f64>([-10.0, 12.1])] {
        assert!((end - 0.5 * 0.1 / 3.0 * 4.0).abs() < 1e-4, "{end} m");
    }
}

/// A rod along x whose ends stick in x, the one more strongly: a push in y turns it, however small the turn at first.
#[test]
fn a_rod_along_an_axis_is_released() {
    fn check<R: Real>(tilt: f64) {
        let table = Table {
            masses: vec![1.0, 1.0],
            grips: vec![[grip(4.0), grip(4.0)], [grip(1.0), grip(0.1)]],
            constraints: rods(&[1.0], false),
            start: (vec![[0.0; 2], [tilt.cos(), tilt.sin()]], vec![[0.0; 2]; 2]),
            h: 1e-2,
        };
        let mut end = [0.0; 2];
        let push = |_| vec![[0.0; 2], [0.0, 2.0]];
        table.run::<R>(60, push, |_, _, state| end = exact(state.q())[1]).unwrap();
        assert!(end[1] > 0.2 && (end[0].hypot(end[1]) - 1.0).abs() < 1e-6, "{tilt}: {end:?}");
    }
    for tilt in [0.0, 1e-9, -1e-6, 1e-4, -1e-3, 1e-2] {
        check::<f32>(tilt);
        check::<f64>(tilt);
    }
}

/// A chain of nodes at random, with friction at random.
fn chain(random: &mut Random, nodes: usize) -> Table {
    let lengths: Vec<f64> = (1..nodes).map(|_| 0.8 + random.symmetric(0.3)).collect();
    let [angles, rates] = [3.0, 2.0].map(|radius| random.vector(nodes - 1, radius));
    let (mut q, mut v) = hanging(&lengths, &angles, &rates);
    q.insert(0, [0.0; 2]);
    v.insert(0, [0.0; 2]);
    let drift = random.array::<2>(1.0);
    v.iter_mut().for_each(|v| *v = [v[0] + drift[0], v[1] + drift[1]]);
    let mut levels = || Grip {
        forward: 1.0 + random.symmetric(0.5),
        backward: 1.0 + random.symmetric(0.5),
        breakaway: 1.1,
    };
    let grips = (0..nodes).map(|_| [levels(), levels()]).collect();
    let masses = (0..nodes).map(|_| 1.0 + random.symmetric(0.5)).collect();
    let h = 10_f64.powf(-2.5 + random.symmetric(0.5));
    Table { masses, grips, constraints: rods(&lengths, false), start: (q, v), h }
}

/// No chain gains energy in any of a hundred thousand steps, and each comes to rest.
#[test]
fn energy_never_grows() {
    fn check<R: Real>() {
        let mut random = Random(11);
        let (mut steps, mut resting) = (0, 0);
        for machine in 0..200 {
            let table = chain(&mut random, 3);
            let (mut last, mut rests) = (f64::INFINITY, false);
            table
                .run::<R>(500, table.unpushed(), |k, _, state| {
                    let now = table.kinetic(state);
                    assert!(now <= last, "chain {machine}, step {k}: {now} J after {last} J");
                    (last, rests) = (now, now == 0.0);
                    steps += 1;
                })
                .unwrap_or_else(|error| panic!("chain {machine}: {error:?}"));
            resting += usize::from(rests);
        }
        println!("{steps} steps, {resting} of 200 chains at rest");
        assert!(steps == 100_000 && resting > 50, "{resting} at rest");
    }
    check::<f32>();
    check::<f64>();
}

/// The least number by which impulses leave their ranges, over the impulses of two rods: a convex function of these.
fn least_excess(excess: impl Fn([f64; 2]) -> f64, radius: f64) -> f64 {
    let least = |of: &dyn Fn(f64) -> f64| {
        let (mut low, mut high) = (-radius, radius);
        for _ in 0..90 {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if of(a) < of(b) { high = b } else { low = a }
        }
        of(0.5 * (low + high))
    };
    least(&|first| least(&|second| excess([first, second])))
}

/// Whether impulses of the rods exist with which those of friction obey its law in one line of a step: between the levels where the velocity is
/// 0, and at its level against it elsewhere. Returns how far they are from that, N s.
fn distance_to_law(table: &Table, q: &Vectors, change: &Vectors, v: &Vectors) -> f64 {
    let half = table.h / 2.0;
    let excess = |lambda: [f64; 2]| {
        let mut friction: Vectors = change.clone();
        for (constraint, lambda) in table.constraints.iter().zip(lambda) {
            let Holonomic::Rod { nodes: [a, b], length } = *constraint else { panic!("a rod") };
            for i in 0..2 {
                let impulse = lambda * (q[a][i] - q[b][i]) / length;
                friction[a][i] -= impulse;
                friction[b][i] += impulse;
            }
        }
        let mut worst = 0.0_f64;
        for (node, grips) in table.grips.iter().enumerate() {
            for (i, grip) in grips.iter().enumerate() {
                let [low, high] = match v[node][i] {
                    v if v > 0.0 => [-grip.forward; 2],
                    v if v < 0.0 => [grip.backward; 2],
                    _ => [-grip.breakaway * grip.forward, grip.breakaway * grip.backward],
                };
                let f = friction[node][i];
                worst = worst.max(f - half * high).max(half * low - f);
            }
        }
        worst
    };
    least_excess(excess, 20.0)
}

/// Every line of every step obeys the law: a search for the rods' impulses, which knows nothing of how the step was solved, finds that friction
/// holds within its levels or slides at them, against the motion.
#[test]
fn friction_obeys_its_law() {
    let mut random = Random(3);
    let (mut worst, mut rests, mut slides) = (0.0_f64, 0, 0);
    for _ in 0..25 {
        let table = Table { h: 0.02, ..chain(&mut random, 3) };
        let mut push_of = Random(random.bits());
        let mut pushes: Vec<Vectors> = vec![];
        let mut before: Option<[Vectors; 3]> = None;
        let forces: Vec<Vectors> = (0..60)
            .map(|k| {
                if k % 5 == 0 {
                    let strength = if k % 10 == 0 { 2.0 } else { 0.8 };
                    pushes.push((0..3).map(|_| push_of.array(strength)).collect());
                }
                pushes.last().unwrap().clone()
            })
            .collect();
        let scaled = |x: &Vectors, by: f64| -> Vectors {
            x.iter().zip(&table.masses).map(|(x, m)| x.map(|x| x * m * by)).collect()
        };
        let minus = |a: &Vectors, b: &Vectors| -> Vectors {
            a.iter().zip(b).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect()
        };
        table
            .run::<f64>(
                60,
                |k| forces[k].clone(),
                |k, _, state| {
                    let now = [exact(state.q()), exact(state.q_carry()), exact(state.v())];
                    if let Some([q0, carry0, v0]) = &before {
                        let moved = minus(&now[0], q0)
                            .iter()
                            .zip(minus(&now[1], carry0))
                            .map(|(a, b)| [a[0] + b[0], a[1] + b[1]])
                            .collect::<Vectors>();
                        let w: Vectors = moved.iter().map(|x| x.map(|x| x / table.h)).collect();
                        let kick: Vectors = forces[k].iter().map(|f| f.map(|f| f * table.h / 2.0)).collect();
                        let first = minus(&minus(&scaled(&w, 1.0), &scaled(v0, 1.0)), &kick);
                        let second = minus(&minus(&scaled(&now[2], 1.0), &scaled(&w, 1.0)), &kick);
                        let found = distance_to_law(&table, q0, &first, &w)
                            .max(distance_to_law(&table, &now[0], &second, &now[2]));
                        worst = worst.max(found / table.h);
                        assert!(found < 1e-8 * table.h, "step {k}: {found} N s beyond its law");
                        let still = now[2].as_flattened().iter().filter(|v| **v == 0.0).count();
                        (rests, slides) = (rests + still, slides + 6 - still);
                    }
                    before = Some(now);
                },
            )
            .unwrap();
    }
    println!("{worst:e} N beyond the law at most; {rests} coordinates at rest and {slides} sliding");
    assert!(rests > 500 && slides > 500, "{rests} at rest, {slides} sliding");
}

/// Long chains that are pushed at random find their motions in every step.
#[test]
fn long_chains_are_solved() {
    fn check<R: Real>(nodes: usize) {
        let mut random = Random(nodes as u64);
        for machine in 0..10 {
            let table = chain(&mut random, nodes);
            let mut pushes = Random(random.bits());
            let mut push: Vectors = vec![];
            let mut error = 0.0_f64;
            table
                .run::<R>(
                    200,
                    |k| {
                        if k % 20 == 0 {
                            push = (0..nodes).map(|_| pushes.array(2.0)).collect();
                        }
                        push.clone()
                    },
                    |_, _, state| error = error.max(rod_error(&table.constraints, &exact(state.q()))),
                )
                .unwrap_or_else(|error| panic!("{nodes} nodes, chain {machine}: {error:?}"));
            assert!(error < 1e-5, "{error}");
        }
    }
    for nodes in [2, 4, 8, 20] {
        check::<f32>(nodes);
        check::<f64>(nodes);
    }
}

/// Between events a rod that slides is followed to order 2.
#[test]
fn sliding_is_of_order_2() {
    let end = |steps: usize| {
        let table = Table {
            masses: vec![1.0, 1.4],
            grips: vec![[grip(0.3), grip(0.5)], [grip(0.4), grip(0.2)]],
            constraints: rods(&[0.9], false),
            start: (vec![[0.0; 2], [0.54, 0.72]], vec![[1.5, 1.2], [1.1, 1.5]]),
            h: 0.4 / steps as f64,
        };
        let mut end = vec![];
        table
            .run::<f64>(
                steps,
                |_| vec![[0.2, 0.0], [0.0, 0.1]],
                |_, _, state| {
                    assert!(state.v().as_flattened().iter().all(|v| *v > 0.0), "an event: {:?}", state.v());
                    end = exact(state.q());
                    end.extend(exact(state.v()));
                },
            )
            .unwrap();
        end
    };
    let reference = end(12_800);
    let error = |steps: usize| {
        let off =
            end(steps).iter().zip(&reference).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum::<f64>();
        (0.4 / steps as f64, off)
    };
    let errors: Vec<_> = [25, 50, 100, 200, 400].into_iter().map(error).collect();
    let slope = log_log_slope(&errors);
    println!("{errors:?}: order {slope}");
    assert!((slope - 2.0).abs() < 0.05, "order {slope}");
}

/// Nodes without rods stop each where c = m a says.
#[test]
fn nodes_without_rods_stop() {
    let table = Table {
        masses: vec![2.0; 11],
        grips: vec![[grip(1.0), grip(0.0)]; 11],
        constraints: vec![],
        start: (vec![[0.0; 2]; 11], (0..11).map(|k| [k as f64 / 10.0, 0.3]).collect()),
        h: 1e-3,
    };
    table
        .run::<f64>(3_000, table.unpushed(), |k, _, state| {
            for (node, (q, v)) in state.q().iter().zip(state.v()).enumerate() {
                let speed = node as f64 / 10.0;
                if k == 2_999 {
                    assert!((q[0] - speed * speed).abs() <= 1e-3 * speed && v[0] == 0.0, "{q:?}");
                    assert!((q[1] - 0.9).abs() < 1e-12 && v[1] == 0.3, "{q:?} {v:?}");
                }
            }
        })
        .unwrap();
}

/// Positions of one step start the state at its end.
#[test]
fn two_positions_start_a_state() {
    let table = chain(&mut Random(29), 3);
    let system = Exact::<f64, 2>::under_gravity(&table.masses, 0.0);
    let system = Gripped::new(&system, &table.grips, 0.01).unwrap();
    let mechanism = Constrained::new(&system, &table.constraints[..]).unwrap();
    let rattle = Rattle::new(table.h, Order::Two);
    let (mut q0, mut rest) = (None, vec![]);
    table
        .run::<f64>(900, table.unpushed(), |k, _, state| {
            if let Some(q0) = q0.replace(state.q().to_vec()) {
                let mut memory = vec![0.0; ParticleState::<f64, 2>::workspace(3, 2)];
                let mut work = vec![0.0; Rattle::workspace(&mechanism)];
                let started =
                    rattle.start(&mechanism, [&q0, state.q()], None, &mut memory, &mut work).unwrap();
                for (found, expected) in started.v().as_flattened().iter().zip(state.v().as_flattened()) {
                    assert!((found - expected).abs() < 1e-8, "step {k}: {found} instead of {expected} m/s");
                }
                rest = started.v().to_vec();
            }
        })
        .unwrap();
    assert_eq!(rest, [[0.0; 2]; 3]);
}

/// Friction that cannot be is refused, and a step that is refused leaves the state.
#[test]
fn errors() {
    let exact = Exact::<f64, 2>::under_gravity(&[1.0, 1.0], 0.0);
    let (grips, rods) = ([[grip(1.0); 2]; 2], rods(&[1.0], false));
    let refused = |grips: &[[Grip<f64>; 2]], width| Gripped::new(&exact, grips, width).map(|_| ());
    assert_eq!(refused(&grips[..1], 0.1), Err(ConstraintError::Shape { expected: 2, given: 1 }));
    for wrong in [grip(-0.1), grip(f64::NAN), grip(f64::INFINITY), Grip { breakaway: 0.9, ..grip(1.0) }] {
        let grips = [[grip(1.0); 2], [grip(1.0), wrong]];
        assert_eq!(refused(&grips, 0.1), Err(ConstraintError::Grip { node: 1, axis: 1 }));
    }
    assert_eq!(refused(&grips, 0.0), Err(ConstraintError::Width { width: 0.0 }));

    let system = Gripped::new(&exact, &grips, 0.1).unwrap();
    let mechanism = Constrained::new(&system, &rods[..]).unwrap();
    let mut memory = vec![0.0; ParticleState::<f64, 2>::workspace(2, 1)];
    let mut work = vec![0.0; Rattle::workspace(&mechanism)];
    let (q, v) = ([[0.0; 2], [1.0, 0.0]], [[0.2, 1.0], [0.2, -0.4]]);
    let mut state = ParticleState::new(&mechanism, &q, &v, &mut memory, &mut work).unwrap();
    let mut saved = [[0.0; 25]; 2];
    state.save(&mut saved[0]).unwrap();
    for (h, order) in [(0.01, Order::Four), (-0.01, Order::Two), (0.0, Order::Two)] {
        let refused = Rattle::new(h, order).step(&mechanism, &mut state, None, &mut work);
        assert!(matches!(refused, Err(ConstraintError::Backward { h }) if h <= 0.0), "{refused:?}");
        let mut memory = vec![0.0; ParticleState::<f64, 2>::workspace(2, 1)];
        let refused = Rattle::new(h, order).start(&mechanism, [&q; 2], None, &mut memory, &mut work);
        assert!(matches!(refused, Err(ConstraintError::Backward { h }) if h <= 0.0));
    }
    let short = &mut vec![0.0; Rattle::workspace(&mechanism) - 1];
    let refused = Rattle::new(0.01, Order::Two).step(&mechanism, &mut state, None, short);
    assert!(matches!(refused, Err(ConstraintError::Workspace { .. })));
    state.save(&mut saved[1]).unwrap();
    assert_eq!(saved[0], saved[1]);
}

/// The smooth law that stands in where derivatives are needed has the levels, and its slope is its derivative.
#[test]
fn the_smooth_law_has_the_levels() {
    let exact = Exact::<f64, 2>::under_gravity(&[1.0], 0.0).hard();
    let grips = [[Grip { forward: 0.5, backward: 0.8, breakaway: 1.3 }, grip(0.0)]];
    let system = Gripped::new(&exact, &grips, 0.1).unwrap();
    for v in [[2.0, 1.0], [-3.0, 0.3], [0.03, -0.2], [0.0, 0.0]] {
        let (drag, plain) = (system.drag(0, &v), exact.drag(0, &v));
        let own = [drag[0] - plain[0], drag[1] - plain[1]];
        assert_eq!(own[1], 0.0);
        if v[0].abs() > 1.0 {
            let level = if v[0] > 0.0 { -0.5 } else { 0.8 };
            assert!((own[0] - level).abs() < 1e-9, "{own:?}");
        }
        let small = 1e-6;
        let [up, down] = [small, -small].map(|dv| system.drag(0, &[v[0] + dv, v[1]])[0]);
        assert!((system.drag_slope(0, &v)[0] - (up - down) / (2.0 * small)).abs() < 1e-6);
    }
}
