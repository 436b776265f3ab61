//! Generalized AdaBoost with decision stumps, and the probabilistic decision list (Sect. 4.2, 4.3).

mod adaboost;
mod calibrated;
mod decision_list;
mod order_search;
mod scores;
mod sorted_examples;
mod stump;
mod stump_search;

pub use adaboost::{AdaBoostError, MIN_EDGE, PERFECT_EDGE, adaboost, boost_from, boost_on};
pub(crate) use calibrated::CalibratedFormat;
pub use calibrated::{Calibrated, CalibratedFileError};
pub use decision_list::{DecisionList, P_FLOOR};
#[doc(hidden)]
pub use order_search::{OrderScore, search_order};
pub use scores::Scores;
#[doc(hidden)]
pub use scores::{CompiledClassifiers, table_scores};
pub use stump::{DecisionStump, Polarity, StrongClassifier, WeightedStump, confidence};
