//! Generalized AdaBoost with decision stumps, and the probabilistic decision list (Sect. 4.2, 4.3).
