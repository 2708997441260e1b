//! Copies of a space, and its contents for pickle.

use jostle_index::{Core, Period, Scalar};
use jostle_space::{Saved, Space};
use numpy::Element;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::{Either, PySpace, is_single, long, shared};
use crate::arrays::{Argument, column, table};
use crate::error::{refused, value_error};
use crate::events::Reduced;
use crate::interrupt::detached;
use crate::keywords::Keywords;
use crate::lock::Shared;
use crate::settings;

#[pymethods]
impl PySpace {
    /// A space with copies of the shapes, with the same ids and the same pairs at the last update.
    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        let space = match &self.space {
            Either::Single(space) => {
                Either::Single(shared(long(py, space, |space| space.clone())?))
            }
            Either::Double(space) => {
                Either::Double(shared(long(py, space, |space| space.clone())?))
            }
        };
        Ok(Self { space })
    }

    /// As `copy.copy`: it holds nothing but numbers.
    fn __deepcopy__(&self, py: Python<'_>, memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        let _ = memo;
        self.__copy__(py)
    }

    /// What pickle stores: the shapes with their ids, and the pairs of the last update.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let restore = py.import("jostle._core")?.getattr("restore_space")?;
        let (settings, state) = with_space!(self, space => {
            let saved = long(py, space, |space| Ok((space.settings(), space.save()?)))?;
            let (settings, saved) = saved.map_err(refused)?;
            (settings, state_of(py, saved)?)
        });
        let options = PyDict::new(py);
        options.set_item("dtype", self.dtype())?;
        options.set_item("period", self.period(py)?)?;
        options.set_item("leaf_capacity", settings.leaf_capacity)?;
        options.set_item("max_depth", settings.max_depth)?;
        options.set_item("threads", settings.threads)?;
        Ok((restore, PyTuple::new(py, [options.into_any(), state.into_any()])?))
    }
}

/// The contents of a space as a tuple of arrays.
fn state_of<T: Scalar + Element>(py: Python<'_>, saved: Saved<T>) -> PyResult<Bound<'_, PyTuple>> {
    let columns = [
        table(py, saved.corners)?.into_any(),
        column(py, saved.radii).into_any(),
        table(py, saved.half_sizes)?.into_any(),
        column(py, saved.filters.into_flattened()).into_any(),
        column(py, saved.generations).into_any(),
        column(py, saved.free).into_any(),
        column(py, saved.ids).into_any(),
        column(py, saved.pairs.into_flattened()).into_any(),
        column(py, saved.changed).into_any(),
        column(py, saved.leaving).into_any(),
        saved.updates.into_bound_py_any(py)?,
        table(py, saved.rides)?.into_any(),
        table(py, saved.ride_centers)?.into_any(),
        column(py, saved.cores.into_iter().map(Core::number).collect()).into_any(),
        saved.calls.into_bound_py_any(py)?,
        column(py, saved.slid).into_any(),
        column(py, saved.moved).into_any(),
        table(py, saved.before)?.into_any(),
        column(py, saved.moved_since).into_any(),
        table(py, saved.starts)?.into_any(),
    ];
    PyTuple::new(py, columns)
}

/// A space with the contents that pickle has stored.
#[pyfunction]
pub fn restore_space<'py>(
    py: Python<'py>,
    options: &Bound<'py, PyDict>,
    state: &Bound<'py, PyTuple>,
) -> PyResult<PySpace> {
    let mut given = Keywords::of("Space", Some(options))?;
    let (settings, period) = settings::index(&mut given)?;
    let space = if is_single(&given.given("dtype"))? {
        Either::Single(restored(py, settings, period, state)?)
    } else {
        Either::Double(restored(py, settings, period, state)?)
    };
    Ok(PySpace { space })
}

fn restored<T: Scalar + Element>(
    py: Python<'_>,
    settings: jostle_base::Settings,
    period: Period<f64>,
    state: &Bound<'_, PyTuple>,
) -> PyResult<Shared<Space<T>>> {
    let item = |index: usize| state.get_item(index);
    let list = |index: usize| -> PyResult<Vec<u32>> {
        let list = Argument::integers("state", &item(index)?)?;
        let len = list.len()?;
        Ok(list.bits_each(len)?.rows(len))
    };
    let pairs = |index: usize| Ok::<_, PyErr>(list(index)?.as_chunks::<2>().0.to_vec());
    let corners = Argument::reals("state", &item(0)?)?;
    let count = corners.boxes_len()?;
    let half_sizes = Argument::reals("state", &item(2)?)?;
    let rides = Argument::integers("state", &item(11)?)?.id_pairs()?;
    let calls = |index: usize| -> PyResult<Vec<i64>> {
        let calls = Argument::integers("state", &item(index)?)?;
        let len = calls.len()?;
        Ok(calls.long_ids("call")?.rows(len))
    };
    let core = |number| {
        let rule = "it must be the state of a space, as pickle stores it";
        Core::of_number(number).ok_or_else(|| value_error("state", "inconsistent", rule))
    };
    let cores = list(13)?.into_iter().map(core).collect::<PyResult<Vec<_>>>()?;
    let (moved, moved_since) = (calls(16)?, list(18)?);
    let saved = Saved {
        corners: corners.boxes(count)?,
        radii: Argument::reals("state", &item(1)?)?.real_each(count)?.rows(count),
        half_sizes: half_sizes.pairs(half_sizes.pairs_len()?)?,
        cores,
        filters: pairs(3)?,
        generations: list(4)?,
        free: list(5)?,
        ids: calls(6)?,
        pairs: pairs(7)?,
        changed: list(8)?,
        leaving: list(9)?,
        updates: item(10)?.extract()?,
        ride_centers: Argument::reals("state", &item(12)?)?.pairs(rides.len())?,
        rides,
        calls: item(14)?.extract()?,
        slid: calls(15)?,
        before: Argument::reals("state", &item(17)?)?.pairs(moved.len())?,
        moved,
        starts: Argument::reals("state", &item(19)?)?.pairs(moved_since.len())?,
        moved_since,
    };
    let restore = || Space::restore(settings, settings::period_in(period)?, saved);
    Ok(shared(detached(py, restore)?.map_err(refused)?))
}
