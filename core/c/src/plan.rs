//! Loading a plan, and what it says about itself.

use crate::arguments::{Given, call, check_length, contents, output, planned};
use crate::config::LEASTACTION_COORDINATES as N;
use crate::contents::{CorePlan, Planned, planned_tag};
use crate::error::Error;
use crate::load::{check_abi, whole};
use crate::status::Status;
use crate::storage::{Model, Plan};
use leastaction_core::plan::PlanFile;

/// Reads and validates a plan, which `leastaction plan` writes, and prepares it in `plan`. Its numbers stay where they are, in flash.
///
/// - `plan_bytes`: `sizeof(leastaction_plan)`, which shows that the structs of this header are the library's.
/// - `abi`: LEASTACTION_ABI, which shows that the functions of this header are the library's.
/// - `file`, `file_bytes`: the whole plan, at a multiple of 4. It must stay there unchanged while `plan` is used.
/// - `model`: the model that the plan was made for; a plan for another one is refused. It is not used afterwards.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 4, 11 and 80 to 93; `plan` then holds no plan, even if it did before.
///
/// # Safety
/// Pointers are NULL or point to the stated number of bytes.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_load"))]
pub unsafe extern "C" fn leastaction_plan_load(
    plan: *mut Plan,
    plan_bytes: usize,
    abi: u32,
    file: *const u8,
    file_bytes: usize,
    model: *const Model,
    error: *mut Error,
) -> Status {
    let load = || {
        let place = Given::new(plan, 1)?.pointer().cast::<Planned>();
        check_length(size_of::<Plan>(), plan_bytes)?;
        check_abi(abi)?;
        // SAFETY: the caller's storage, which is large enough for its contents and as aligned.
        unsafe { (&raw mut (*place).tag).write(0) };
        // SAFETY: the caller's promise.
        let (bytes, model) = unsafe { (whole(file, file_bytes, 4)?, contents(model, 6)?) };
        let file = PlanFile::parse(bytes)?;
        file.check_model(model.fingerprint)?;
        let plan = CorePlan::at_most(file)?;
        // SAFETY: as above.
        unsafe { place.write(Planned { tag: planned_tag(place), plan }) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, load) }
}

/// Sizes and times of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct PlanDescription {
    /// Fingerprint of the model that the plan was made for: the checksum of its file.
    pub model: u32,
    /// Number of coordinates: LEASTACTION_COORDINATES.
    pub coordinates: u32,
    /// Number of driven coordinates, at least 1.
    pub driven: u32,
    /// Tick h > 0, s, of the loop that the plan was made for.
    pub h: f32,
    /// Number of ticks over which a command is held, at least 1: a node.
    pub ticks_per_node: u32,
    /// Length of the motion in ticks; from this tick on the plan is its goal.
    pub ticks: u32,
    /// Length of the motion, s.
    pub seconds: f32,
}

/// Writes sizes and times of a plan. Fails with statuses 1, 2 and 14.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_describe"))]
pub unsafe extern "C" fn leastaction_plan_describe(
    plan: *const Plan,
    description: *mut PlanDescription,
    error: *mut Error,
) -> Status {
    let describe = || {
        // SAFETY: the caller's promise.
        let plan = unsafe { planned(plan) }?;
        let (out, header) = (Given::new(description, 2)?, plan.file().header());
        let description = PlanDescription {
            model: header.model,
            coordinates: header.n() as u32,
            driven: header.commands() as u32,
            h: header.h,
            ticks_per_node: header.ticks_per_node,
            ticks: plan.ticks(),
            seconds: plan.seconds(),
        };
        // SAFETY: the caller's promise.
        unsafe { out.write(description) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, describe) }
}

/// Writes which coordinates a plan drives and the limits of their commands.
///
/// - `n`: LEASTACTION_COORDINATES.
/// - `driven`: `n` marks, 1 for a driven coordinate, 0 for another.
/// - `least`, `most`: least and largest command (N or N m), `n` numbers each; 0 where nothing drives.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3 and 14.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_limits"))]
pub unsafe extern "C" fn leastaction_plan_limits(
    plan: *const Plan,
    n: usize,
    driven: *mut u8,
    least: *mut f32,
    most: *mut f32,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let plan = unsafe { planned(plan) }?;
        check_length(N, n)?;
        let driven = Given::new(driven.cast::<[u8; N]>(), 3)?;
        let (least, most) = (output(least, 4)?, output(most, 5)?);
        let limits = plan.file().header().limits;
        let ends = |end: fn(&[f32; 2]) -> f32| {
            plan.spread(&core::array::from_fn(|i| limits.get(i).map_or(0.0, end)))
        };
        // SAFETY: the caller's promise.
        unsafe {
            driven.write(plan.spread(&[1.0; N]).map(|mark| mark as u8));
            least.write(ends(|[least, _]| *least));
            most.write(ends(|[_, most]| *most));
        }
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}
