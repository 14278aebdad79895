//! Clocks of the boards: from a crystal, as an internal oscillator is up to 1% off, and all velocities with it.

use embassy_stm32::Config;
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPreDiv, PllSource, Sysclk};
use embassy_stm32::time::mhz;

/// 168 MHz from the 8 MHz of the programmer.
#[cfg(feature = "nucleo-f446re")]
pub fn config() -> Config {
    use embassy_stm32::rcc::{APBPrescaler, PllPDiv};
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse { freq: mhz(8), mode: HseMode::Bypass });
    rcc.pll_src = PllSource::HSE;
    let divp = Some(PllPDiv::DIV2);
    rcc.pll = Some(Pll { prediv: PllPreDiv::DIV4, mul: PllMul::MUL168, divp, divq: None, divr: None });
    (rcc.apb1_pre, rcc.apb2_pre) = (APBPrescaler::DIV4, APBPrescaler::DIV2);
    rcc.sys = Sysclk::PLL1_P;
    config
}

/// 170 MHz from the crystal of 24 MHz.
#[cfg(feature = "nucleo-g474re")]
pub fn config() -> Config {
    use embassy_stm32::rcc::PllRDiv;
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse { freq: mhz(24), mode: HseMode::Oscillator });
    let (source, divr) = (PllSource::HSE, Some(PllRDiv::DIV2));
    rcc.pll = Some(Pll { source, prediv: PllPreDiv::DIV6, mul: PllMul::MUL85, divp: None, divq: None, divr });
    rcc.boost = true;
    rcc.sys = Sysclk::PLL1_R;
    config
}
