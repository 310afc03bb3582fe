//! Structure builders: a draft, not part of ABI 1.1.

use crate::{Cx, Info, Node, Params, Result, Tracks};

/// Grows a skeleton from grouped tracks.
pub trait Structure: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;

    /// Grows it: parents before their children.
    ///
    /// # Errors
    /// Whatever keeps it from that.
    fn grow(params: &Self::Params, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Vec<Node>>;
}
