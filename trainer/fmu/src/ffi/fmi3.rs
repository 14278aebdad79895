//! FMI 3.0: the functions that a unit has.
//!
//! # Safety
//! All functions trust the pointers of the importer as the standard demands: null, or of the stated length.

use super::log::{Log, Logger3};
use super::memory::{present, read, text, write};
use super::{attempt, free, instantiate, per_state, resources, set_states, states};
use crate::{FmuError, Instance, Interface, Unit};
use std::ffi::{c_char, c_int, c_void};

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    _logging_on: u8,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There are only errors, which are always logged.
    unsafe { attempt(instance, |_| Ok(())) }
}

/// Reads the model and creates an instance.
unsafe fn create(
    interface: Interface,
    token: *const c_char,
    path: *const c_char,
) -> Result<Instance, FmuError> {
    let token = unsafe { text("the instantiation token", token) }?;
    let path = unsafe { text("the path of the resources", path) }?;
    Instance::new(Unit::read(&resources::of_path(path)?)?, interface, token)
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    token: *const c_char,
    path: *const c_char,
    _visible: u8,
    _logging_on: u8,
    environment: *mut c_void,
    logger: Option<Logger3>,
) -> *mut c_void {
    let log = Log::Three { logger, environment };
    instantiate(log, || unsafe { create(Interface::ModelExchange, token, path) })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    path: *const c_char,
    _visible: u8,
    _logging_on: u8,
    event_mode_used: u8,
    _early_return_allowed: u8,
    _intermediate_variables: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    logger: Option<Logger3>,
    _intermediate_update: *const c_void,
) -> *mut c_void {
    let log = Log::Three { logger, environment };
    instantiate(log, || {
        if event_mode_used != 0 {
            return Err(FmuError::Missing("event mode in co-simulation"));
        }
        unsafe { create(Interface::CoSimulation, token, path) }
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _path: *const c_char,
    _visible: u8,
    _logging_on: u8,
    environment: *mut c_void,
    logger: Option<Logger3>,
    _clock_update: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> *mut c_void {
    instantiate(Log::Three { logger, environment }, || Err(FmuError::Missing("scheduled execution")))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _tolerance_defined: u8,
    _tolerance: f64,
    start: f64,
    _stop_defined: u8,
    _stop: f64,
) -> c_int {
    unsafe { attempt(instance, |own| own.set_start(start).and_then(|()| own.enter_initialization())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::exit_initialization) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterEventMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::enter_event_mode) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Terminate(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::terminate) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Reset(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::reset) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    values_count: usize,
) -> c_int {
    let work = |own: &mut Instance| {
        FmuError::check_length("the list of values", count, values_count)?;
        let found = own.get(unsafe { read("the list of value references", references, count) }?)?;
        unsafe { write("the list of values", values, &found) }
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    values_count: usize,
) -> c_int {
    let work = |own: &mut Instance| {
        let references = unsafe { read("the list of value references", references, count) }?;
        own.set(references, unsafe { read("the list of values", values, values_count) }?)
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe { states::get(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFMUState(instance: *mut c_void, state: *mut c_void) -> c_int {
    unsafe { states::set(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeFMUState(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe { states::free(instance, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> c_int {
    unsafe { states::size(instance, state, size) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    unsafe { states::serialize(instance, state, bytes, size) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    unsafe { states::deserialize(instance, bytes, size, state) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut c_void,
    need_update: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    values_changed: *mut bool,
    next_event_defined: *mut bool,
    next_event: *mut f64,
) -> c_int {
    let work = |own: &mut Instance| {
        own.update_discrete_states()?;
        for flag in [need_update, terminate, nominals_changed, values_changed, next_event_defined] {
            unsafe { write("a place of an event's flag", flag, &[false]) }?;
        }
        unsafe { write("the place of the next event", next_event, &[0.0]) }
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: *mut c_void) -> c_int {
    unsafe { attempt(instance, Instance::enter_continuous_time_mode) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut c_void,
    _no_set_state_prior: u8,
    enter_event_mode: *mut bool,
    terminate: *mut bool,
) -> c_int {
    let work = |own: &mut Instance| {
        own.completed_integrator_step()?;
        for flag in [enter_event_mode, terminate] {
            unsafe { write("a place of a step's flag", flag, &[false]) }?;
        }
        Ok(())
    };
    unsafe { attempt(instance, work) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetTime(instance: *mut c_void, time: f64) -> c_int {
    unsafe { attempt(instance, |own| own.set_time(time)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetContinuousStates(
    instance: *mut c_void,
    values: *const f64,
    count: usize,
) -> c_int {
    unsafe { set_states(instance, values, count) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: *mut c_void,
    values: *mut f64,
    count: usize,
) -> c_int {
    unsafe { per_state(instance, values, count, Instance::derivatives) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStates(instance: *mut c_void, values: *mut f64, count: usize) -> c_int {
    unsafe { per_state(instance, values, count, Instance::continuous_states) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: *mut c_void,
    values: *mut f64,
    count: usize,
) -> c_int {
    unsafe { per_state(instance, values, count, Instance::nominals) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetEventIndicators(instance: *mut c_void, _values: *mut f64, count: usize) -> c_int {
    unsafe { attempt(instance, |_| FmuError::check_length("the list of event indicators", 0, count)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfEventIndicators(instance: *mut c_void, count: *mut usize) -> c_int {
    unsafe { attempt(instance, |_| write("the place of the number", count, &[0])) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: *mut c_void, count: *mut usize) -> c_int {
    unsafe { attempt(instance, |own| write("the place of the number", count, &[own.states()])) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    point: f64,
    size: f64,
    _no_set_state_prior: u8,
    event_handling_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_successful_time: *mut f64,
) -> c_int {
    let flags = [event_handling_needed, terminate, early_return];
    let work = |own: &mut Instance| {
        for flag in flags {
            unsafe { write("a place of a step's flag", flag, &[false]) }?;
        }
        present("the place of the last successful time", last_successful_time)?;
        let done = own.do_step(point, size);
        unsafe { write("the place of the last successful time", last_successful_time, &[own.time()]) }?;
        done
    };
    unsafe { attempt(instance, work) }
}
