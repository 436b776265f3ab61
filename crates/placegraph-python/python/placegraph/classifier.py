"""The generalized AdaBoost decision list as an estimator of scikit-learn (``placegraph[sklearn]``)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from . import _native

__all__ = ["PlaceClassifier"]

MAX_CLASSES = 8


class PlaceClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Generalized AdaBoost with decision stumps, one classifier per class, in a probabilistic decision list.

    The classifier of placegraph, for any table of features: one boosted vote of stumps per class against all others,
    asked one after the other in the order that is right most often; the last class takes what remains. Features are
    taken as 32-bit floats.

    Parameters
    ----------
    rounds : int, default 100
        Boosting rounds: stumps per class at most.
    temperature : float, default 1.0
        Divides the votes before they become confidences: above 1 it softens them.
    n_jobs : int, optional
        Number of threads; by default one a core. The result does not depend on it.

    Attributes
    ----------
    classes_ : ndarray, (K,)
        The classes.
    n_features_in_ : int
        Number of features.
    order_ : ndarray, (K,)
        The classes in the order in which they are asked.
    feature_votes_ : ndarray, (K, F)
        Sum of the votes of every feature, for every class.
    """

    def __init__(self, rounds: int = 100, temperature: float = 1.0, n_jobs: int | None = None) -> None:
        self.rounds = rounds
        self.temperature = temperature
        self.n_jobs = n_jobs

    def fit(self, X: ArrayLike, y: ArrayLike) -> PlaceClassifier:
        """Learns from the rows of ``X``, (n, F), of the classes ``y``, (n,)."""
        rows: NDArray[np.float32]
        rows, y = validate_data(self, X, y, dtype=np.float32)
        check_classification_targets(y)
        if self.rounds < 1:
            raise ValueError(f"expected rounds of at least 1, found {self.rounds}")
        if not 0 < self.temperature < np.inf:
            raise ValueError(f"expected a temperature above 0, found {self.temperature}")
        self.classes_, codes = np.unique(y, return_inverse=True)
        n_classes = len(self.classes_)
        if not 2 <= n_classes <= MAX_CLASSES:
            raise ValueError(f"expected 2 to {MAX_CLASSES} classes, found {n_classes} class(es)")
        order, self._stumps = _native.fit_list(
            rows, codes.astype(np.uint8), n_classes, int(self.rounds), float(self.temperature), self._threads()
        )
        self._order = list(order)
        self.order_ = self.classes_[self._order]
        self.feature_votes_ = np.zeros((n_classes, rows.shape[1]))
        for votes, (features, _, _, alphas) in zip(self.feature_votes_, self._stumps):
            np.add.at(votes, features, alphas)
        return self

    def predict_proba(self, X: ArrayLike) -> NDArray[np.float64]:
        """(n, K) probability of every class for the rows of ``X``."""
        check_is_fitted(self)
        rows: NDArray[np.float32] = validate_data(self, X, dtype=np.float32, reset=False)
        p = _native.list_probabilities(rows, self._order, self._stumps, float(self.temperature), self._threads())
        wide = p.astype(np.float64)
        return wide / wide.sum(axis=1, keepdims=True)

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """(n,) the most probable class of the rows of ``X``."""
        probabilities = self.predict_proba(X)
        most: NDArray[Any] = self.classes_[probabilities.argmax(axis=1)]
        return most

    def _threads(self) -> int | None:
        return None if self.n_jobs is None or self.n_jobs < 1 else int(self.n_jobs)
