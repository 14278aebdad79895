//! The loops against sums written out, and the square root against the host's.

use leastaction_fpu::{f16, half, single, sqrt};
use proptest::prelude::*;

fn rows<const P: usize>(numbers: &[f32]) -> &[[f32; P]] {
    numbers.as_chunks().0
}

/// Checks every sum, computed term by term in the stated order.
fn check<const P: usize>(
    numbers: &[f32],
    x: &[f32],
    accumulate: impl Fn(&[[f32; P]], &[f32], &mut [f32; P]),
    transposed: impl Fn(&[[f32; P]], &[f32; P], &mut [f32]),
) {
    let (rows, start) = (rows::<P>(numbers), core::array::from_fn::<f32, P, _>(|l| l as f32 - 1.5));
    let mut sum = start;
    accumulate(rows, x, &mut sum);
    for (l, sum) in sum.iter().enumerate() {
        let expected = rows.iter().zip(x).fold(start[l], |sum, (row, x)| sum + row[l] * x);
        assert_eq!(sum.to_bits(), expected.to_bits());
    }
    let mut x_bar = x.to_vec();
    transposed(rows, &start, &mut x_bar);
    for (j, (x_bar, x)) in x_bar.iter().zip(x).enumerate() {
        let mut products: Vec<f32> =
            rows.get(j).map_or(vec![], |row| (0..P).map(|l| row[l] * start[l]).collect());
        while products.len() > 1 {
            let upper = products.split_off(products.len() / 2);
            products.iter_mut().zip(upper).for_each(|(low, high)| *low += high);
        }
        let expected = products.first().map_or(*x, |sum| x + sum);
        assert_eq!(x_bar.to_bits(), expected.to_bits());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Sums in the stated order, also for more rows than inputs, or fewer.
    #[test]
    fn sums_are_in_the_stated_order(
        numbers in prop::collection::vec(-2.0_f32..2.0, 0..100),
        x in prop::collection::vec(-3.0_f32..3.0, 0..20),
    ) {
        check::<8>(&numbers, &x, single::accumulate_8, single::transposed_8);
        check::<4>(&numbers, &x, single::accumulate_4, single::transposed_4);
    }

    #[test]
    fn the_root_is_correctly_rounded(bits in any::<u32>()) {
        let x = f32::from_bits(bits);
        let (ours, host) = (sqrt(x), x.sqrt());
        prop_assert!(ours.to_bits() == host.to_bits() || (ours.is_nan() && host.is_nan()), "{x:e}");
    }
}

#[test]
fn halves_give_what_their_numbers_give() {
    let halves: Vec<f16> = (0..8 * 13).map(|i| f16::from_f32((i as f32 * 0.37).sin())).collect();
    let x: Vec<f32> = (0..13).map(|i| (i as f32 * 1.7).cos()).collect();
    // Slices at every alignment that two bytes allow.
    for shift in 0..8 {
        let halves = &halves[shift..];
        let wide: Vec<f32> = halves.iter().map(|h| h.to_f32()).collect();
        macro_rules! same {
            ($p:literal, $accumulate:ident, $transposed:ident) => {
                let (mut sums, mut x_bars) = ([[0.25_f32; $p]; 2], [x.clone(), x.clone()]);
                single::$accumulate(rows::<$p>(&wide), &x, &mut sums[0]);
                half::$accumulate(halves.as_chunks().0, &x, &mut sums[1]);
                single::$transposed(rows::<$p>(&wide), &sums[0], &mut x_bars[0]);
                half::$transposed(halves.as_chunks().0, &sums[1], &mut x_bars[1]);
                assert_eq!(sums[0].map(f32::to_bits), sums[1].map(f32::to_bits));
                assert_eq!(x_bars[0], x_bars[1]);
            };
        }
        same!(8, accumulate_8, transposed_8);
        same!(4, accumulate_4, transposed_4);
    }
}
