//! Greedy matching: pairs of neighbours by falling shape.
//!
//! A pair is taken where both are still alone. At least half as many pairs are found as the largest
//! matching has. The cost is that of sorting the pairs.

/// Pair neighbours by falling shape, down to a least one; the mate of each tria or -1.
///
/// Of equal shapes the pair whose first tria comes first is taken first.
pub fn greedy_matching(neighbours: &[[i32; 3]], shapes: &[[f64; 3]], least: f64) -> Vec<i32> {
    let mut pairs: Vec<Pair> = Vec::with_capacity(3 * neighbours.len() / 2);
    for (t, across) in neighbours.iter().enumerate() {
        for k in 0..3 {
            // each pair once; adding 0 makes the two zeros one
            if across[k] > t as i32 && shapes[t][k] >= least {
                pairs.push(Pair { one: t, other: across[k] as usize, shape: shapes[t][k] + 0.0 });
            }
        }
    }
    pairs.sort_by(|a, b| b.shape.total_cmp(&a.shape));
    let mut mate = vec![-1; neighbours.len()];
    for Pair { one, other, .. } in pairs {
        if mate[one] < 0 && mate[other] < 0 {
            mate[one] = other as i32;
            mate[other] = one as i32;
        }
    }
    mate
}

/// Two trias that may become a quad.
struct Pair {
    one: usize,
    other: usize,
    shape: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_pair_comes_first_and_poor_ones_never() {
        let chain = [[1, -1, -1], [0, 2, -1], [1, 3, -1], [2, -1, -1]];
        let shapes = [[0.4, -2.0, -2.0], [0.4, 0.9, -2.0], [0.9, 0.7, -2.0], [0.7, -2.0, -2.0]];
        assert_eq!(greedy_matching(&chain, &shapes, 0.0), [-1, 2, 1, -1]);
        assert_eq!(greedy_matching(&chain, &shapes, 0.95), [-1, -1, -1, -1]);
    }
}
