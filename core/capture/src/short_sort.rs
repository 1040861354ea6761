//! A stable sort of short lists.
//!
//! Each type that the standard library sorts adds 4 kB of wasm, which saves no time on a list of channels.

pub(crate) trait ShortSort<T> {
    /// Sorts in a time that grows with the square of the length: only for lists of channels and the like.
    fn sort_short_by_key<K: Ord>(&mut self, key: impl FnMut(&T) -> K);
}

impl<T> ShortSort<T> for [T] {
    fn sort_short_by_key<K: Ord>(&mut self, mut key: impl FnMut(&T) -> K) {
        for end in 1..self.len() {
            let Some((item, sorted)) = self.get_mut(..=end).and_then(<[T]>::split_last_mut) else { return };
            let item_key = key(item);
            let at = sorted.partition_point(|other| key(other) <= item_key);
            if let Some(tail) = self.get_mut(at..=end) {
                tail.rotate_right(1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_like_the_standard_library_and_keeps_the_order_of_equal_keys() {
        let mut random = 1_u32;
        for length in [0, 1, 2, 3, 7, 64] {
            let mut items: Vec<(u32, usize)> = (0..length)
                .map(|index| {
                    random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (random >> 28, index)
                })
                .collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            items.sort_short_by_key(|item| item.0);
            assert_eq!(items, expected);
        }
    }
}
