//! How good a labeling is: cell, class and room measures.
