//! Mixed-up units and placeholder numbers are noticed; ordinary logs raise no doubts.

use leastaction_data::{Dataset, Doubt, Rows, Trajectory};

/// An oscillation of 1 rad at ω rad/s with its velocities.
fn oscillation(omega: f64, h: f64, samples: usize) -> Dataset {
    let column = |f: &dyn Fn(f64) -> f64| {
        let values = (0..samples).map(|k| f(omega * h * k as f64)).collect();
        Rows::from_flat(1, values).unwrap()
    };
    let (q, v) = (column(&f64::sin), column(&|phase| omega * phase.cos()));
    Dataset {
        n: 1,
        h,
        control: None,
        trajectories: vec![Trajectory { id: 4, t0: 0.0, q, v: Some(v), a: None, u: None }],
    }
}

fn said(data: &Dataset) -> Vec<String> {
    data.doubts("a").iter().map(Doubt::to_string).collect()
}

#[test]
fn ordinary_logs_raise_none() {
    for (omega, h) in [(3.0, 0.05), (3.0, 1e-4), (30.0, 0.05), (1e-3, 0.4), (300.0, 1e-5)] {
        assert_eq!(said(&oscillation(omega, h, 400)), Vec::<String>::new(), "{omega} {h}");
    }
    // Noise of 0.01 on positions at 10 kHz hides the velocity.
    let mut noisy = oscillation(3.0, 1e-4, 4000);
    let q = noisy.trajectories[0].q.as_flat().iter().zip(0_u64..);
    let q = q.map(|(q, k)| q + 0.01 * ((k * 7919 % 1013) as f64 / 1013.0 - 0.5)).collect();
    noisy.trajectories[0].q = Rows::from_flat(1, q).unwrap();
    assert_eq!(said(&noisy), Vec::<String>::new());
}

#[test]
fn a_resting_coordinate_raises_none() {
    let mut still = oscillation(3.0, 0.05, 40);
    still.trajectories[0].q = Rows::from_flat(1, vec![0.0; 40]).unwrap();
    assert_eq!(said(&still), Vec::<String>::new());
    still.trajectories[0].v = Some(Rows::from_flat(1, vec![0.0; 40]).unwrap());
    assert_eq!(said(&still), Vec::<String>::new());
}

#[test]
fn milliseconds_are_noticed() {
    let mut data = oscillation(3.0, 0.05, 100);
    data.h = 50.0;
    let expected = [
        "the step is 50 s, long for a mechanism; if t or h is in milliseconds, give seconds".to_owned(),
        "v0 is 1004 times what q0 and the step say; is t or h in milliseconds?".to_owned(),
    ];
    assert_eq!(said(&data), expected);
    data.h = 5e-5;
    assert_eq!(said(&data), ["v0 is 1e-3 times what q0 and the step say; is t or h in milliseconds?"]);
    data.h = 50.0;
    data.trajectories[0].v = None;
    assert_eq!(said(&data), expected[..1]);
    data.h = 5e-8;
    assert_eq!(said(&data), ["the step is 5e-8 s, short for a log; give t or h in seconds"]);
}

#[test]
fn degrees_are_noticed() {
    let mut data = oscillation(3.0, 0.05, 100);
    let v = data.trajectories[0].v.as_ref().unwrap().map(f64::to_degrees);
    data.trajectories[0].v = Some(v);
    let one = said(&data);
    assert!(one.len() == 1 && one[0].ends_with("; is one of them in degrees?"), "{one:?}");
    let turning = (0..40).map(|k| (170.0 + 3.0 * f64::from(k) + 180.0) % 360.0 - 180.0).collect();
    data.trajectories[0] =
        Trajectory { q: Rows::from_flat(1, turning).unwrap(), v: None, ..data.trajectories[0].clone() };
    let expected =
        "q0 is an angle and jumps by 360 at sample 4 of trajectory 4; if it is in degrees, give radians";
    assert_eq!(said(&data), [expected]);
    assert_eq!(data.doubts("t"), []);
}

#[test]
fn values_of_failed_sensors_are_noticed() {
    let spoilt = |sample: usize, value: f64| {
        let mut data = oscillation(3.0, 0.05, 40);
        let mut q = data.trajectories[0].q.as_flat().to_vec();
        q[sample] = value;
        data.trajectories[0].q = Rows::from_flat(1, q).unwrap();
        said(&data)
    };
    assert_eq!(
        spoilt(7, 1e308),
        [
            "q0 is 1e308 at sample 7 of trajectory 4, which no mechanism reaches in SI units; look for a sensor that failed there, or \
             for a number that stands for none"
        ]
    );
    let leap =
        "q0 leaps at sample 7 of trajectory 4, at 2e11 m/s or rad/s; look for a sensor that failed there";
    assert_eq!(spoilt(7, 1e10), [leap]);
    let mut data = oscillation(3.0, 0.05, 40);
    data.trajectories[0].v = Some(Rows::from_flat(1, vec![-1e300; 40]).unwrap());
    let [Doubt::Value { field: "v", sample: 0, .. }] = data.doubts("a")[..] else {
        panic!("{:?}", said(&data))
    };
}
