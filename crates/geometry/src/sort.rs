//! Sorting of short lists, for which the standard library calls a function that is built for size in WebAssembly.

/// Up to so many are sorted by insertion.
const FEW: usize = 24;

/// Sorts by a key, not keeping the order of what has the same.
#[inline]
pub(super) fn sort<T: Copy, K: Ord>(list: &mut [T], key: impl Fn(&T) -> K) {
    if list.len() > FEW {
        list.sort_unstable_by_key(key);
        return;
    }
    for i in 1..list.len() {
        let item = list[i];
        let own = key(&item);
        let mut at = i;
        while at > 0 && key(&list[at - 1]) > own {
            list[at] = list[at - 1];
            at -= 1;
        }
        list[at] = item;
    }
}
