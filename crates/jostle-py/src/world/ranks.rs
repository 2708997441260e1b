//! The part of a distributed world that one rank has, for `jostle.mpi`.

use jostle_base::memory;
use jostle_world::ranks;
use jostle_world::ranks::{Traffic, read_records};
use jostle_world::{StateHash, Touched};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::PyWorld;
use crate::arrays::{column, count, number, table};
use crate::communicator::PyCommunicator;
use crate::error::refused;
use crate::interrupt::detached;
use crate::results;

/// Pairs and their categories.
type Pairs<'py> = (Bound<'py, PyArray2<i64>>, Bound<'py, PyArray2<u32>>);

/// Own particles and the ids of all rows; calls, messages, bytes, repeated steps, rebalances.
type Numbers<'py> = (usize, Bound<'py, PyArray1<i64>>, [u64; 5]);

#[pymethods]
impl PyWorld {
    /// Make this world a part of a distributed one. For `jostle.mpi`.
    fn _distribute(
        &self,
        py: Python<'_>,
        communicator: &Bound<'_, PyAny>,
        ids: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<()> {
        let (communicator, ids) = (PyCommunicator::new(communicator)?, ids.as_array().to_vec());
        let done = detached(py, || {
            let mut state = self.state.lock()?;
            PyResult::Ok(ranks::distribute(&mut state.world, Box::new(communicator), ids))
        })??;
        done.map_err(refused)
    }

    /// Raise ValueError for what a distributed world cannot do. For `jostle.mpi`.
    fn _check_distributable(&self, py: Python<'_>) -> PyResult<()> {
        ranks::check_distributable(&self.state(py)?.world).map_err(refused)
    }

    /// The number of sub-steps that was given, or None. For `jostle.mpi`.
    fn _given_substeps(&self, py: Python<'_>) -> PyResult<Option<usize>> {
        Ok(self.rules(py)?.substeps)
    }

    /// Find out what the automatic number of sub-steps depends on. For `jostle.mpi`.
    fn _agree_on_losses(&self, py: Python<'_>) -> PyResult<()> {
        self.long(py, |state| ranks::agree_on_losses(&mut state.world))?.map_err(refused)
    }

    /// Make a step of a distributed world. For `jostle.mpi`.
    fn _step_distributed(&self, py: Python<'_>, dt: f64) -> PyResult<()> {
        let done = detached(py, || {
            let mut state = self.state.lock()?;
            PyResult::Ok(state.step_within_call(dt, 1))
        })??;
        done.map(|_| ()).map_err(refused)
    }

    /// The arguments of `step`, which are refused as there. For `jostle.mpi`.
    fn _arguments_of_step(
        &self,
        py: Python<'_>,
        dt: &Bound<'_, PyAny>,
        steps: &Bound<'_, PyAny>,
    ) -> PyResult<(f64, usize)> {
        let (dt, steps) = (number("dt", dt)?, count("steps", steps, 0)?);
        self.long(py, |state| state.world.step(dt, 0))?.map_err(refused)?;
        Ok((dt, steps))
    }

    /// Begin a call of `step` of a distributed world. For `jostle.mpi`.
    fn _begin_steps(&self, py: Python<'_>, dt: f64) -> PyResult<()> {
        self.long(py, |state| state.begin(dt))?.map_err(refused)
    }

    /// End a call of `step` of a distributed world. For `jostle.mpi`.
    fn _end_steps(&self, py: Python<'_>) -> PyResult<()> {
        self.long(py, |state| state.world.clear_accelerations())
    }

    /// This rank's part in the energy of forces between kinds. No step is possible after it. For
    /// `jostle.mpi`.
    fn _own_energy_of_pairs(&self, py: Python<'_>) -> PyResult<f64> {
        self.long(py, |state| ranks::own_energy_of_pairs(&mut state.world))?.map_err(refused)
    }

    /// The numbers of this rank's part. For `jostle.mpi`.
    fn _own<'py>(&self, py: Python<'py>) -> PyResult<Option<Numbers<'py>>> {
        let own = self.long(py, |state| ranks::own_particles(&state.world))?;
        Ok(own.map(|own| {
            let Traffic { calls, messages, bytes } = own.traffic;
            let numbers = [calls, messages, bytes, own.repeats, own.rebalances];
            (own.own, column(py, own.ids), numbers)
        }))
    }

    /// The number of own particles, that of all ranks, and that of own ones that are awake. For
    /// `jostle.mpi`.
    fn _counts(&self, py: Python<'_>) -> PyResult<(usize, usize, usize)> {
        let world = &self.state(py)?.world;
        let (own, all) = ranks::own_and_all(world);
        Ok((own, all, ranks::own_awake(world)))
    }

    /// The ids of the own particles, and the id that is given next. For `jostle.mpi`.
    fn _own_ids<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, i64)> {
        let (ids, next) = self.long(py, |state| ranks::own_ids(&state.world))?.map_err(refused)?;
        Ok((column(py, ids), next))
    }

    /// Replace the ids, and the id that is given next. For `jostle.mpi`.
    fn _set_ids(&self, py: Python<'_>, ids: PyReadonlyArray1<'_, i64>, next: i64) -> PyResult<()> {
        let ids = ids.as_array().to_vec();
        self.long(py, |state| ranks::set_ids(&mut state.world, &ids, next))?.map_err(refused)
    }

    /// Add the particles of records to this rank, with these ids; so many on all ranks. For
    /// `jostle.mpi`.
    fn _add_records(
        &self,
        py: Python<'_>,
        records: Vec<u8>,
        ids: PyReadonlyArray1<'_, i64>,
        count: usize,
    ) -> PyResult<()> {
        let ids = ids.as_array().to_vec();
        self.long(py, |state| ranks::add(&mut state.world, records, &ids, count))?.map_err(refused)
    }

    /// Remove the particles with these ids, which all ranks give. For `jostle.mpi`.
    fn _remove_ids(&self, py: Python<'_>, ids: PyReadonlyArray1<'_, i64>) -> PyResult<()> {
        let ids = ids.as_array().to_vec();
        self.long(py, |state| ranks::remove(&mut state.world, &ids))?.map_err(refused)
    }

    /// Remove the copies of particles of other ranks. For `jostle.mpi`.
    fn _drop_ghosts(&self, py: Python<'_>) -> PyResult<()> {
        self.long(py, |state| ranks::drop_ghosts(&mut state.world))
    }

    /// The own particles as records. For `jostle.mpi`.
    fn _own_records<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let records = self.long(py, |state| ranks::own_records(&state.world))?;
        Ok(PyBytes::new(py, &records.map_err(refused)?))
    }

    /// What is kept of the own particles from step to step, as in `jostle.mpi.records`. For `jostle.mpi`.
    fn _own_kept<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyBytes>; 5]> {
        let all = self.long(py, |state| ranks::own_kept(&state.world))?;
        Ok(all.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// Take what `_own_kept` returned, of all particles of this world. For `jostle.mpi`.
    fn _take_kept(
        &self,
        py: Python<'_>,
        kept: &[u8],
        resting: &[u8],
        pushes: &[u8],
        members: &[u8],
        touches: &[u8],
    ) -> PyResult<()> {
        let all = [kept, resting, pushes, members, touches];
        self.long(py, |state| ranks::take_kept(&mut state.world, all))?.map_err(refused)
    }

    /// The pairs of sleeping islands that touched, each on one rank. For `jostle.mpi`.
    fn _own_touches_asleep<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        results::world_contacts(py, self.long(py, |state| ranks::own_touches_asleep(&state.world))?)
    }

    /// Pairs of particles, or of particles and walls, that touched, and their categories: at the end of the call before,
    /// in this one, and at its end. For `jostle.mpi`.
    fn _own_touches<'py>(&self, py: Python<'py>, at_walls: bool) -> PyResult<Vec<Pairs<'py>>> {
        let [pairs, walls] =
            self.long(py, |state| state.world.record().touches())?.map_err(refused)?;
        let all = if at_walls { walls } else { pairs };
        let columns = |all: Vec<Touched>| {
            let pairs = memory::collect(all.iter().map(|of| of.pair)).map_err(refused)?;
            let categories = memory::collect(all.iter().map(|of| of.categories));
            Ok((table(py, pairs)?, table(py, categories.map_err(refused)?)?))
        };
        all.into_iter().map(columns).collect()
    }

    /// The given accelerations along x, along y and angular, in the order of rows. For `jostle.mpi`.
    fn _given<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let all = self.long(py, |state| {
            let mut all = memory::copy(state.world.all_external())?;
            memory::resize(&mut all, state.world.len(), [0.0; 3])?;
            Ok(all)
        })?;
        table(py, all.map_err(refused)?)
    }

    /// Replace them. For `jostle.mpi`.
    fn _give(&self, py: Python<'_>, given: PyReadonlyArray2<'_, f32>) -> PyResult<()> {
        let all = given.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
        self.long(py, |state| state.world.set_all_external(all))?.map_err(refused)
    }

    /// The old and the new ids of own particles that merged. For `jostle.mpi`.
    fn _own_renumbering<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        table(
            py,
            self.long(py, |state| state.world.record().merged().unwrap_or_default().to_vec())?,
        )
    }

    /// A world like this one with the particles of records. For `jostle.mpi`.
    fn _of_records(&self, py: Python<'_>, records: &[u8]) -> PyResult<Self> {
        let world = self.long(py, |state| ranks::of_records(&state.world, records))?;
        Ok(Self::of(world.map_err(refused)?))
    }

    /// Choose domains again after so many steps. For tests.
    fn _rebalance_every(&self, py: Python<'_>, steps: u64) -> PyResult<()> {
        ranks::rebalance_every(&mut self.state(py)?.world, steps);
        Ok(())
    }

    /// Tell the time that this rank needs for each particle. For `jostle.mpi`.
    fn _set_work(&self, py: Python<'_>, work: f64) -> PyResult<()> {
        ranks::set_work(&mut self.state(py)?.world, work);
        Ok(())
    }
}

/// The checksum of bytes in files. For `jostle.mpi`.
#[pyfunction]
pub fn checksum(bytes: &[u8]) -> u64 {
    jostle_base::bytes::checksum(bytes)
}

/// Begin the hash of the state of `total` particles. For `jostle.mpi`.
#[pyfunction]
pub fn begin_hash(total: usize) -> u64 {
    StateHash::begin(total).0
}

/// The parts of the hash of the state that depend on the particles of records. For `jostle.mpi`.
#[pyfunction]
pub fn hash_parts(records: &[u8]) -> Vec<usize> {
    StateHash::parts(&read_records(records).0)
}

/// Continue the hash of the state with one part of the particles of records. For `jostle.mpi`.
#[pyfunction]
pub fn hash_records(hash: u64, records: &[u8], part: usize) -> u64 {
    StateHash(hash).and(&read_records(records).0, part).0
}

/// The fields of a record after the id, as NumPy writes them. For `jostle.mpi`.
#[pyfunction]
pub fn record_fields() -> Vec<(&'static str, String)> {
    let format = |(name, number, count)| {
        let number = match number {
            "f64" => "<f8",
            "f32" => "<f4",
            "u32" => "<u4",
            "u8" => "u1",
            _ => "?",
        };
        (name, if count == 1 { number.to_string() } else { format!("({count},){number}") })
    };
    jostle_world::ranks::record_fields().into_iter().map(format).collect()
}
