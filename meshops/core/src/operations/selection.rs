//! Selections of elements by ranges of their numbers.

/// Which of `count` elements are in one of some ranges of numbers from 1.
///
/// The ends of a range are included and may come in any order; numbers that there are not select
/// nothing. The cost grows with the lengths of the ranges.
pub fn select_ranges(ranges: &[[i32; 2]], count: usize) -> Vec<bool> {
    let mut selected = vec![false; count];
    for [one, other] in ranges {
        let (low, high) = ((*one).min(*other).max(1) as usize, (*one).max(*other).max(0) as usize);
        if let Some(range) = selected.get_mut(low - 1..high.min(count)) {
            range.fill(true);
        }
    }
    selected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_included_in_any_order() {
        assert_eq!(select_ranges(&[[2, 3], [5, 4]], 6), [false, true, true, true, true, false]);
        assert_eq!(select_ranges(&[[-3, 1], [9, 8], [i32::MIN, -1]], 2), [true, false]);
    }
}
