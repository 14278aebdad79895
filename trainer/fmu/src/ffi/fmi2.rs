//! FMI 2.0.
//!
//! # Safety
//! All functions trust the pointers of the importer as the standard demands: null, or of the stated length.

use super::log::{Log, Logger2};
use super::memory::{present, read, text, write};
use super::{DISCARD, OK, attempt, free, instantiate, per_state, resources, set_states, states};
use crate::{FmuError, Instance, Interface, Unit};
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: Option<Logger2>,
    allocate: *const c_void,
    free: *const c_void,
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy)]
struct EventInfo {
    new_discrete_states_needed: c_int,
    terminate: c_int,
    nominals_changed: c_int,
    values_changed: c_int,
    next_event_defined: c_int,
    next_event: f64,
}

/// `fmi2Type` of co-simulation; that of model exchange is 0.
const CO_SIMULATION: c_int = 1;
/// `fmi2StatusKind` of the last successful time.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2StatusKind` of a wish to terminate.
const TERMINATED: c_int = 3;

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetDebugLogging(
    instance: *mut c_void,
    _logging_on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There are only errors, which are always logged.
    unsafe { attempt(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    token: *const c_char,
    location: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging_on: c_int,
) -> *mut c_void {
    instantiate(unsafe { log(name, callbacks) }, || {
        let interface =
            if kind == CO_SIMULATION { Interface::CoSimulation } else { Interface::ModelExchange };
        let token = unsafe { text("the GUID", token) }?;
        let location = unsafe { text("the location of the resources", location) }?;
        Instance::new(Unit::read(&resources::of_uri(location)?)?, interface, token)
    })
}

unsafe fn log(name: *const c_char, callbacks: *const Callbacks) -> Log {
    let name = if name.is_null() { CString::default() } else { unsafe { CStr::from_ptr(name) }.to_owned() };
    let callbacks = unsafe { callbacks.as_ref() };
    Log::Two {
        logger: callbacks.and_then(|own| own.logger),
        environment: callbacks.map_or(std::ptr::null_mut(), |own| own.environment),
        name,
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeInstance(instance: *mut c_void) {
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetupExperiment(
    instance: *mut c_void,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start: f64,
    _stop_defined: c_int,
    _stop: f64,
) -> c_int {
    unsafe { attempt(instance, |own| own.set_start(start)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2EnterInitializationMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::enter_initialization) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2ExitInitializationMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::exit_initialization) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Terminate(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::terminate) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Reset(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::reset) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
) -> c_int {
    let work = |own: &mut Instance| {
        let found = own.get(unsafe { read("the list of value references", references, count) }?)?;
        unsafe { write("the list of values", values, &found) }
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const f64,
) -> c_int {
    let work = |own: &mut Instance| {
        let references = unsafe { read("the list of value references", references, count) }?;
        own.set(references, unsafe { read("the list of values", values, count) }?)
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetFMUstate(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe { states::get(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetFMUstate(instance: *mut c_void, state: *mut c_void) -> c_int {
    unsafe { states::set(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeFMUstate(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe { states::free(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SerializedFMUstateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> c_int {
    unsafe { states::size(instance, state, size) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SerializeFMUstate(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    unsafe { states::serialize(instance, state, bytes, size) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DeSerializeFMUstate(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    unsafe { states::deserialize(instance, bytes, size, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2EnterEventMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::enter_event_mode) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2NewDiscreteStates(instance: *mut c_void, info: *mut EventInfo) -> c_int {
    let nothing = EventInfo {
        new_discrete_states_needed: 0,
        terminate: 0,
        nominals_changed: 0,
        values_changed: 0,
        next_event_defined: 0,
        next_event: 0.0,
    };
    let work = |own: &mut Instance| {
        own.update_discrete_states()?;
        unsafe { write("the place of the event's information", info, &[nothing]) }
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2EnterContinuousTimeMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::enter_continuous_time_mode) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2CompletedIntegratorStep(
    instance: *mut c_void,
    _no_set_state_prior: c_int,
    enter_event_mode: *mut c_int,
    terminate: *mut c_int,
) -> c_int {
    let work = |own: &mut Instance| {
        own.completed_integrator_step()?;
        for flag in [enter_event_mode, terminate] {
            unsafe { write("a place of a step's flag", flag, &[0]) }?;
        }
        Ok(())
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetTime(instance: *mut c_void, time: f64) -> c_int {
    unsafe { attempt(instance, |own| own.set_time(time)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetContinuousStates(
    instance: *mut c_void,
    values: *const f64,
    count: usize,
) -> c_int {
    unsafe { set_states(instance, values, count) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetDerivatives(instance: *mut c_void, values: *mut f64, count: usize) -> c_int {
    unsafe { per_state(instance, values, count, Instance::derivatives) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetEventIndicators(instance: *mut c_void, _values: *mut f64, count: usize) -> c_int {
    unsafe { attempt(instance, |_| FmuError::check_length("the list of event indicators", 0, count)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetContinuousStates(instance: *mut c_void, values: *mut f64, count: usize) -> c_int {
    unsafe { per_state(instance, values, count, Instance::continuous_states) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    instance: *mut c_void,
    values: *mut f64,
    count: usize,
) -> c_int {
    unsafe { per_state(instance, values, count, Instance::nominals) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DoStep(
    instance: *mut c_void,
    point: f64,
    size: f64,
    _no_set_state_prior: c_int,
) -> c_int {
    unsafe { attempt(instance, |own| own.do_step(point, size)) }
}

/// Answers a question about the last step, or not: the status is then [`DISCARD`].
unsafe fn answer<T: Copy>(
    instance: *mut c_void,
    to: *mut T,
    value: impl FnOnce(&Instance) -> Option<T>,
) -> c_int {
    let mut known = true;
    let work = |own: &mut Instance| {
        present("the place of the status", to)?;
        match value(own) {
            Some(value) => unsafe { write("the place of the status", to, &[value]) },
            None => {
                known = false;
                Ok(())
            }
        }
    };
    let status = unsafe { attempt(instance, work) };
    if status == OK && !known { DISCARD } else { status }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStatus(instance: *mut c_void, _kind: c_int, value: *mut c_int) -> c_int {
    unsafe { answer(instance, value, |_| None) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealStatus(instance: *mut c_void, kind: c_int, value: *mut f64) -> c_int {
    unsafe { answer(instance, value, |own| (kind == LAST_SUCCESSFUL_TIME).then(|| own.time())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetIntegerStatus(instance: *mut c_void, _kind: c_int, value: *mut c_int) -> c_int {
    unsafe { answer(instance, value, |_| None) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBooleanStatus(instance: *mut c_void, kind: c_int, value: *mut c_int) -> c_int {
    unsafe { answer(instance, value, |_| (kind == TERMINATED).then_some(0)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStringStatus(
    instance: *mut c_void,
    _kind: c_int,
    value: *mut *const c_char,
) -> c_int {
    unsafe { answer(instance, value, |_| None) }
}
