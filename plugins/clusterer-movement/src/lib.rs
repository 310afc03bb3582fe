//! Clustering by movement as a honami plugin.
