//! The numbers of new places.

use std::collections::BTreeSet;

use crate::topology::PlaceId;

/// Numbers for new places, in their order: those after `last`, then those from 1 on, that no place of the earlier result has;
/// if there are too few, those of its places that are gone; and if all are taken, numbers above [`PlaceId::MAX`].
pub(super) fn new_ids<'a>(
    last: PlaceId,
    earlier: &'a BTreeSet<PlaceId>,
    kept: &'a BTreeSet<PlaceId>,
) -> impl Iterator<Item = PlaceId> + use<'a> {
    let max = PlaceId::MAX.0;
    let in_turn = move || (last.0.saturating_add(1)..=max).chain(1..=last.0.min(max)).map(PlaceId);
    let unused = in_turn().filter(|id| !earlier.contains(id));
    let vanished = in_turn().filter(|id| earlier.contains(id) && !kept.contains(id));
    unused.chain(vanished).chain((max + 1..).map(PlaceId))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn ids(numbers: impl IntoIterator<Item = u32>) -> BTreeSet<PlaceId> {
        numbers.into_iter().map(PlaceId).collect()
    }

    fn first_ids(n: usize, last: u32, earlier: &[u32], kept: &[u32]) -> Vec<u32> {
        let (earlier, kept) = (ids(earlier.iter().copied()), ids(kept.iter().copied()));
        new_ids(PlaceId(last), &earlier, &kept).take(n).map(|id| id.0).collect()
    }

    #[test]
    fn numbers_are_given_in_turn() {
        assert_eq!(
            first_ids(3, 7, &[1, 2, 5], &[1]),
            [8, 9, 10],
            "not 5, which vanished, nor 6, which was given before"
        );
        let max = PlaceId::MAX.0;
        assert_eq!(
            first_ids(4, max - 1, &[1, 3], &[3]),
            [max, 2, 4, 5],
            "after the last number come those that are free"
        );
        assert_eq!(first_ids(2, u32::MAX, &[u32::MAX], &[]), [1, 2], "nothing wraps");
    }

    #[test]
    fn numbers_of_vanished_places_are_given_again_only_where_no_others_are_left() {
        let max = PlaceId::MAX.0;
        let earlier: Vec<u32> = (1..=max).collect();
        let kept: Vec<u32> = (1..=max).filter(|id| id % 2 == 0).collect();
        assert_eq!(first_ids(2, 10, &earlier, &kept), [11, 13]);
        assert_eq!(first_ids(2, 10, &earlier, &earlier), [max + 1, max + 2]);
    }

    /// 1000 places; every night 300 are replaced by others.
    #[test]
    fn twenty_years_of_nights_keep_numbers_small_and_apart() {
        let mut last = PlaceId(1000);
        let mut places: Vec<PlaceId> = (1..=1000).map(PlaceId).collect();
        let mut given_on: BTreeMap<PlaceId, u32> = BTreeMap::new();
        for night in 1..=20 * 365 {
            let earlier: BTreeSet<PlaceId> = places.iter().copied().collect();
            let first = night as usize * 7919 % 700;
            let kept: BTreeSet<PlaceId> = places
                .iter()
                .enumerate()
                .filter(|(i, _)| !(first..first + 300).contains(i))
                .map(|(_, &id)| id)
                .collect();
            let new: Vec<PlaceId> = new_ids(last, &earlier, &kept).take(300).collect();
            last = new[299];
            for &id in &new {
                assert!((PlaceId(1)..=PlaceId::MAX).contains(&id) && !earlier.contains(&id));
                if let Some(before) = given_on.insert(id, night) {
                    assert!(night - before >= 200, "{id:?} again after {} nights", night - before);
                }
            }
            places = kept.into_iter().chain(new).collect();
            assert_eq!(places.len(), 1000);
        }
    }
}
