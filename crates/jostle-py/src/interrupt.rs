//! Long calls, which release the GIL and are interrupted if a signal handler raises.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use jostle_base::interrupt;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Interval at which signal handlers run.
const POLL_EVERY: Duration = Duration::from_millis(50);

/// The interval for threads that do not run signal handlers: longer than any call.
const NEVER: Duration = Duration::from_secs(86_400);

thread_local! {
    /// The time at which the current call of this thread runs the signal handlers next; None before
    /// the first poll.
    static NEXT: Cell<Option<Instant>> = const { Cell::new(None) };
    /// The exception of a signal handler during the current call of this thread.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// Calls `work` without the GIL. An exception of a signal handler interrupts it and is returned; a
/// panic becomes a RuntimeError.
pub fn detached<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let outer = NEXT.take();
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(|| interrupt::watch(poll, work))));
    NEXT.set(outer);
    match RAISED.take() {
        Some(error) => Err(error),
        None => done.map_err(|panic| panic_error(&*panic)),
    }
}

/// As [`detached`], for work that must not be interrupted.
pub fn detached_to_the_end<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|panic| panic_error(&*panic))
}

/// Runs the signal handlers at [`POLL_EVERY`]; returns whether one of them has raised.
fn poll() -> bool {
    let now = Instant::now();
    let Some(next) = NEXT.get() else {
        NEXT.set(Some(now + POLL_EVERY));
        return false;
    };
    if now < next {
        return false;
    }
    let (raised, wait) = Python::attach(|py| match runs_signal_handlers(py) {
        Ok(true) => (py.check_signals().err(), POLL_EVERY),
        Ok(false) => (None, NEVER),
        Err(error) => (Some(error), POLL_EVERY),
    });
    NEXT.set(Some(Instant::now() + wait));
    RAISED.set(raised);
    RAISED.with_borrow(Option::is_some)
}

/// Keeps an exception of a function that the current call of [`detached`] has called.
pub fn raise(error: PyErr) {
    RAISED.set(Some(error));
}

/// Whether this is the thread on which Python runs signal handlers.
fn runs_signal_handlers(py: Python<'_>) -> PyResult<bool> {
    static NAMES: PyOnceLock<[Py<PyAny>; 2]> = PyOnceLock::new();
    let [own, main] = NAMES.get_or_try_init(py, || {
        let threading = py.import("threading")?;
        let name = |name| PyResult::Ok(threading.getattr(name)?.unbind());
        PyResult::Ok([name("get_ident")?, name("main_thread")?])
    })?;
    own.bind(py).call0()?.eq(main.bind(py).call0()?.getattr("ident")?)
}

/// The exception for a panic.
pub fn panic_error(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
    PyRuntimeError::new_err(format!("internal error of jostle ({text}); please report it"))
}
