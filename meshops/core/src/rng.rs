//! Random numbers that are the same on every machine.
//!
//! A xorshift generator of 64 bits (Marsaglia, Xorshift RNGs, 2003): fast, and good enough to draw
//! moves by. Its period is 2^64 - 1.

/// What scatters small seeds over all states: 2^64 over the golden ratio.
const SCATTER: u64 = 0x9E37_79B9_7F4A_7C15;

/// A generator of random numbers.
#[derive(Clone, Debug)]
pub struct Xorshift {
    state: u64,
}

impl Xorshift {
    /// The generator of a seed. That of -1 draws nothing but 0.
    #[inline]
    pub fn new(seed: i64) -> Self {
        Self { state: (seed.wrapping_add(1) as u64).wrapping_mul(SCATTER) }
    }

    /// The next number, at least 0 and less than 1.
    #[inline]
    pub fn draw(&mut self) -> f64 {
        let mut x = self.state;
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        self.state = x;
        (x >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// The next number, a row of something that has `count` of them.
    #[inline]
    pub fn draw_row(&mut self, count: usize) -> usize {
        (self.draw() * count as f64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_are_from_0_to_below_1(seed in any::<i64>()) {
            let mut random = Xorshift::new(seed);
            for _ in 0..100 {
                prop_assert!((0.0..1.0).contains(&random.draw()));
                prop_assert!(random.draw_row(7) < 7);
            }
        }
    }

    #[test]
    fn a_seed_has_its_numbers() {
        let mut random = Xorshift::new(17);
        let mut again = Xorshift::new(17);
        let mut other = Xorshift::new(18);
        let first = random.draw();
        assert_eq!(first, again.draw());
        assert_ne!(first, other.draw());
        assert_ne!(first, random.draw());
    }
}
