//! Probabilistic relaxation labeling over the 8-neighborhood (Sect. 4.5).
