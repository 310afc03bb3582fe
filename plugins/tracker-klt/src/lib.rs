//! The pyramidal KLT tracker as a honami plugin.
