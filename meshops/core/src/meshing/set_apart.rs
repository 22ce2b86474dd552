//! Setting nodes apart that are at the same place.
//!
//! Places are found in a table by their bits (open addressing); the cost grows with their number.

use crate::vectors::Vector;

/// Move nodes that are where an earlier one is by a step for each earlier one, along all axes.
pub fn set_apart(places: &mut [Vector], step: f64) {
    let size = (2 * places.len()).next_power_of_two().max(4);
    // the first node of each place
    let mut table = vec![usize::MAX; size];
    let mut later = vec![0u32; places.len()];
    let mut steps = vec![0u32; places.len()];
    for (n, place) in places.iter().enumerate() {
        let mut slot = hash(place) as usize & (size - 1);
        while table[slot] != usize::MAX && places[table[slot]] != *place {
            slot = (slot + 1) & (size - 1);
        }
        if table[slot] == usize::MAX {
            table[slot] = n;
        } else {
            let first = table[slot];
            later[first] += 1;
            steps[n] = later[first];
        }
    }
    for (place, steps) in places.iter_mut().zip(steps) {
        if steps > 0 {
            *place = place.map(|x| x + step * f64::from(steps));
        }
    }
}

/// A number that is the same for equal places.
fn hash(place: &Vector) -> u64 {
    let mut mixed = 0u64;
    for x in place {
        // adding 0 makes the two zeros one
        mixed = (mixed ^ (x + 0.0).to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        mixed ^= mixed >> 32;
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_third_at_a_place_moves_twice_as_far() {
        let mut places = [[0.0, 1.0, 2.0], [3.0; 3], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0]];
        set_apart(&mut places, 0.5);
        assert_eq!(places, [[0.0, 1.0, 2.0], [3.0; 3], [0.5, 1.5, 2.5], [1.0, 2.0, 3.0]]);
    }

    proptest! {
        #[test]
        fn each_is_moved_by_how_many_were_there(
            places in prop::collection::vec(prop::array::uniform3(0i32..3), 0..40),
        ) {
            let places: Vec<Vector> = places.iter().map(|place| place.map(f64::from)).collect();
            let mut apart = places.clone();
            set_apart(&mut apart, 0.25);
            for n in 0..places.len() {
                let before = places[..n].iter().filter(|place| **place == places[n]).count();
                prop_assert_eq!(apart[n], places[n].map(|x| x + 0.25 * before as f64));
            }
        }
    }
}
