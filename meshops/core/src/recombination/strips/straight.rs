//! Open strips that leave a tria and cross quads from side to opposite side.
//!
//! The graph of elements is whole. The cost grows with the trias and the reach, and with the mesh
//! for the arrays.

use super::{NO_RUNG, Rung, StripGround, Strips};
use crate::mesh::is_tria;

/// Sides of a tria.
const SIDES: usize = 3;

/// All straight strips that leave some trias.
///
/// Those that end at another tria behind at most `reach` quads (or `steps`, where that is more), each
/// found once, and those that end in one of the first `steps` quads.
pub fn straight_strips(
    ground: StripGround<'_>,
    trias: &[i32],
    reach: usize,
    steps: usize,
) -> Strips {
    let longest = reach.max(steps).saturating_add(2);
    let mut strips = Strips::default();
    let mut row: Vec<i32> = Vec::new();
    let mut crossed: Vec<Rung> = Vec::new();
    // marks begin at 1: memory that is all 0 is not touched before it is needed
    let mut seen = vec![0u32; ground.elements.len()];
    let mut done = vec![false; ground.elements.len()];
    for number in 0..SIDES * trias.len() {
        let (mut cell, mut side) = (trias[number / SIDES] as usize, number % SIDES);
        let mark = number as u32 + 1;
        done[cell] = true;
        seen[cell] = mark;
        row.clear();
        row.push(cell as i32);
        crossed.clear();
        while row.len() < longest {
            crossed.push(ground.rung(cell, side));
            let Some((entered, entry)) = ground.graph.enter(cell, side) else { break };
            if !ground.editable[entered] || seen[entered] == mark {
                break;
            }
            cell = entered;
            seen[cell] = mark;
            row.push(cell as i32);
            let at_tria = is_tria(ground.elements[cell]);
            if if at_tria { !done[cell] } else { row.len() - 1 <= steps } {
                strips.cells.extend_from_slice(&row);
                strips.rungs.extend_from_slice(&crossed);
                strips.rungs.push(NO_RUNG);
                strips.close();
            }
            if at_tria {
                break;
            }
            side = (entry + 2) % 4;
        }
    }
    strips
}
