//! Models whose masses, lengths and angles all differ, with the numbers of MuJoCo 4.0.0 for them: `mj_inverse` with
//! contacts, limits, damping, dry friction and springs disabled, and `mj_fullM`, printed by Python with all digits.

use super::{held, names};

/// Numbers of MuJoCo at [`state`], in its order of joints.
struct Oracle<const N: usize> {
    names: [&'static str; N],
    forces: [f64; N],
    gravity: [f64; N],
    mass: [[f64; N]; N],
}

/// State of N joints: 0.3 + 0.7 sin(k + 1), cos(1.3 k), sin(2 k + 0.5).
fn state<const N: usize>() -> [[f64; N]; 3] {
    let of = |value: fn(f64) -> f64| std::array::from_fn(|k| value(k as f64));
    [of(|k| 0.3 + 0.7 * (k + 1.0).sin()), of(|k| (1.3 * k).cos()), of(|k| (2.0 * k + 0.5).sin())]
}

fn near(found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12 * scale, "{found} {expected}");
    }
}

fn compare<const N: usize>(text: &str, oracle: &Oracle<N>) {
    let tree = held(text).tree;
    assert_eq!(names(&tree), oracle.names);
    let [q, v, a] = state::<N>();
    near(&tree.inverse_dynamics(&q, &v, &a), &oracle.forces);
    near(&tree.inverse_dynamics(&q, &[0.0; N], &[0.0; N]), &oracle.gravity);
    near(&tree.mass_matrix(&q).concat(), oracle.mass.as_flattened());
}

/// Classes, frames, all orientations, several joints in one body, anchors, references, shapes, and a welded body.
const FEATURES: &str = r#"<mujoco model="features">
  <compiler angle="degree" eulerseq="zYx" autolimits="true"/>
  <option gravity="0.7 -1.1 -9.3" timestep="0.002"><flag contact="disable" limit="disable"/></option>
  <default>
    <joint damping="0.3" armature="0.021"/>
    <geom density="850" group="1"/>
    <default class="heavy">
      <geom density="2300"/>
      <joint armature="0.037" axis="1 2 -1"/>
      <default class="heavier"><geom density="3100" type="capsule" size="0.031 0.12"/><joint pos="0.01 0.02 -0.03"/></default>
    </default>
    <default class="slide"><joint type="slide" axis="0.3 -1 0.2" range="-0.4 0.7" armature="0.9"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="post" pos="0.11 -0.23 0.37" euler="10 -25 40">
      
      <body name="first" pos="0.05 0.07 0.19" axisangle="1 2 3 35" childclass="heavy">
        <joint name="a" type="hinge" pos="0.03 -0.02 0.04" axis="0.2 0.3 1" range="-100 120" ref="15"/>
        <geom type="box" size="0.05 0.08 0.13" pos="0.02 0.01 0.06" euler="5 15 -30"/>
        <geom type="ellipsoid" size="0.04 0.07 0.09" pos="-0.1 0.03 0.2" mass="0.83"/>
        <body name="second" pos="0.1 0.2 0.3" xyaxes="1 0.2 0.1 -0.3 1 0.2">
          <inertial pos="0.02 0.05 -0.04" quat="0.9 0.1 -0.2 0.3" mass="1.7" diaginertia="0.021 0.034 0.029"/>
          <joint name="b"/>
          <joint name="c" class="slide" ref="0.13"/>
          <joint name="d" pos="0.06 0.05 -0.07" axis="0 1 1" armature="0" class="heavier"/>
          <body name="welded" pos="0.2 -0.1 0.15" zaxis="1 -1 0.5">
            <geom class="heavier" pos="0.01 0.02 0.03"/>
            <geom class="heavier" type="cylinder" size="0.06" fromto="0.1 0.2 0.3 -0.1 0.05 0.2"/>
            <frame pos="0.1 0.2 0.05" euler="20 30 -10" childclass="slide">
              <geom type="box" size="0.03 0.04" fromto="0.1 0.2 0.3 -0.1 0.05 0.2"/>
              <body name="third" pos="0.3 0.01 0.02" quat="1 0.5 -0.3 0.2">
                <joint name="e" axis="1 0.1 0.2"/>
                <inertial pos="0.1 0.02 0.03" mass="0.9" fullinertia="0.011 0.013 0.017 0.001 -0.002 0.0015"/>
                
              </body>
            </frame>
          </body>
        </body>
        <body name="fourth" pos="-0.2 0.1 0.1">
          <joint name="f" axis="0 0.4 1" armature="0.11"/>
          <geom class="heavier" type="capsule" fromto="0 0 0 0.1 0.3 -0.2"/>
          <geom type="sphere" size="0.07" pos="0.1 0.3 -0.2"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

#[test]
fn elements_mean_what_they_mean_to_mujoco() {
    let oracle = Oracle {
        names: ["a", "b", "c", "d", "e", "f"],
        forces: [
            10.49672276730167,
            -72.31709481612243,
            -103.60565440363399,
            -5.741215499142461,
            0.14475803369634166,
            -10.83698906361795,
        ],
        gravity: [
            10.24680246225233,
            -72.3020705238465,
            -86.44551513997855,
            -1.9701839412845878,
            -0.2549634372257069,
            -10.07234737101068,
        ],
        mass: [
            [
                5.91563343484759,
                -0.06445728460611161,
                -3.6822571338043084,
                3.7635097828093635,
                0.16850868506951897,
                0.7175516290157812,
            ],
            [
                -0.06445728460611161,
                4.894473901846397,
                3.170981074769623,
                1.226013668207671,
                0.15099942646105524,
                0.0,
            ],
            [
                -3.6822571338043084,
                3.170981074769623,
                16.39720303082423,
                -0.6678098222554261,
                0.10629699495832257,
                0.0,
            ],
            [
                3.7635097828093635,
                1.226013668207671,
                -0.6678098222554261,
                3.751026821868181,
                0.13692676077248422,
                0.0,
            ],
            [0.16850868506951897, 0.15099942646105524, 0.10629699495832257, 0.13692676077248422, 1.8, 0.0],
            [0.7175516290157812, 0.0, 0.0, 0.0, 0.0, 0.7465114984411679],
        ],
    };
    compare(FEATURES, &oracle);
    let tree = held(FEATURES).tree;
    let [first, .., last] = tree.bodies() else { panic!() };
    assert_eq!(first.limits.position, [-100.0_f64, 120.0].map(f64::to_radians));
    assert_eq!(last.limits.position, [f64::NEG_INFINITY, f64::INFINITY]);
    assert_eq!(tree.bodies()[4].limits.position, [-0.4, 0.7]);
}

/// Settings of the compiler that change masses and inertias.
const CHANGED: &str = r#"<mujoco>
  <compiler angle="radian" eulerseq="XYZ" balanceinertia="true" boundmass="0.4" boundinertia="0.003" settotalmass="7.3"
            inertiafromgeom="true" inertiagrouprange="1 2"/>
  <worldbody>
    <body name="hub" pos="0.2 0.1 0.3" euler="0.3 -0.4 0.7">
      <joint name="swing" axis="1 0.3 0.1" armature="0.05" limited="false" range="-1 1"/>
      <inertial pos="0 0 0" mass="99" diaginertia="9 9 9"/>
      <geom type="cylinder" size="0.06 0.11" group="1" pos="0.1 0 0.2"/>
      <geom type="sphere" size="0.5" group="0"/>
      <body name="rod" pos="0.1 0.3 -0.2" zaxis="0 0 -1">
        <joint name="lift" type="slide" pos="1 2 3" axis="0 1 0.5" ref="-0.2"/>
        <geom type="capsule" size="0.02 0.25" group="2"/>
      </body>
      <body name="speck" pos="0.4 0.1 -0.1">
        <joint name="spin" axis="0.5 1 0" pos="0 0.05 0.02"/>
        <geom type="sphere" size="0.02" group="1" mass="0.01" pos="0.1 0.05 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

#[test]
fn settings_of_the_compiler_mean_what_they_mean_to_mujoco() {
    let oracle = Oracle {
        names: ["swing", "lift", "spin"],
        forces: [-2.3713362712585835, -13.501440464259725, -0.2312168376060322],
        gravity: [-3.574884646999188, -12.89263947261048, -0.21193668508179303],
        mass: [
            [1.6809548764733815, -0.4004161548114838, 0.009053562617934025],
            [-0.4004161548114838, 1.3609552485620877, 0.0],
            [0.009053562617934025, 0.0, 0.013078419518941897],
        ],
    };
    compare(CHANGED, &oracle);
}
