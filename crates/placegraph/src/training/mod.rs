//! From labeled maps to a model.
