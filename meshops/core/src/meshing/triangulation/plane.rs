//! Places in the plane: areas and distances.

/// A place in the plane.
pub type Place = [f64; 2];

/// Twice the signed area of the tria of two nodes and a place.
#[inline]
pub fn area_to(points: &[Place], a: i32, b: i32, [x, y]: Place) -> f64 {
    let (a, b) = (points[a as usize], points[b as usize]);
    (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
}

/// Twice the signed area of three nodes.
#[inline]
pub fn turn(points: &[Place], a: i32, b: i32, c: i32) -> f64 {
    area_to(points, a, b, points[c as usize])
}

/// Squared distance of two nodes.
#[inline]
pub fn squared_distance(points: &[Place], a: i32, b: i32) -> f64 {
    let (a, b) = (points[a as usize], points[b as usize]);
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    x * x + y * y
}
