//! Instance-based associative Markov networks (Sect. 4.6).
