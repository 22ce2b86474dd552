//! Lists of different lengths one behind the other (compressed sparse rows).

/// Lists one behind the other: list `i` is `items[start[i]..start[i + 1]]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Csr {
    /// Where each list starts, and last where the last one ends.
    pub start: Vec<i32>,
    /// The lists.
    pub items: Vec<i32>,
}

/// A borrowed [`Csr`].
#[derive(Clone, Copy, Debug)]
pub struct CsrView<'a> {
    /// Where each list starts, and last where the last one ends.
    pub start: &'a [i32],
    /// The lists.
    pub items: &'a [i32],
}

impl Csr {
    /// Borrow it.
    #[inline]
    pub fn view(&self) -> CsrView<'_> {
        CsrView { start: &self.start, items: &self.items }
    }

    /// List `i`.
    #[inline]
    pub fn list(&self, i: usize) -> &[i32] {
        self.view().list(i)
    }

    /// How many lists there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.view().len()
    }

    /// Whether there is no list.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.view().is_empty()
    }
}

impl<'a> CsrView<'a> {
    /// List `i`.
    #[inline]
    pub fn list(&self, i: usize) -> &'a [i32] {
        &self.items[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// How many items list `i` has; 0 where there is no such list.
    #[inline]
    pub fn count(&self, i: usize) -> i32 {
        match self.start.get(i + 1) {
            Some(end) => end.wrapping_sub(self.start[i]),
            None => 0,
        }
    }

    /// How many lists there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Whether there is no list.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
