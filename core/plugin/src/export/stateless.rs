//! Instances that hold parameters and nothing else.

use super::{State, Told};
use crate::{Params, Result};
use std::ffi::{CStr, c_void};

/// A kind of plugin that is one function of its input.
pub(crate) trait Function: 'static {
    type Params: Params;
    type Table: 'static;
    const INTERFACE: &'static CStr;
    const TABLE: &'static Self::Table;
}

pub(crate) struct Stateless<F: Function> {
    pub(crate) params: F::Params,
}

impl<F: Function> State for Stateless<F> {
    type Params = F::Params;

    fn new() -> Self {
        Self { params: F::Params::default() }
    }

    fn set(&mut self, params: F::Params, _: Told) -> Result<()> {
        self.params = params;
        Ok(())
    }

    fn interface(id: &CStr) -> *const c_void {
        if id == F::INTERFACE { (&raw const *F::TABLE).cast() } else { std::ptr::null() }
    }
}
