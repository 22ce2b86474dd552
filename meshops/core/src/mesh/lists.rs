//! Lists of anything, made one after the other.

/// Lists one behind the other: list `i` is `items[start[i]..start[i + 1]]`.
///
/// What is pushed belongs to the list that is open; [`close`](Self::close) ends it and opens the
/// next one. Like [`Csr`](super::csr::Csr), for items that are no rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Lists<T> {
    /// Where each list starts, and last where the open one does.
    pub start: Vec<i32>,
    /// The lists.
    pub items: Vec<T>,
}

impl<T> Lists<T> {
    /// No list yet, with room for some.
    pub fn with_room(lists: usize) -> Self {
        let mut start = Vec::with_capacity(lists + 1);
        start.push(0);
        Self { start, items: Vec::new() }
    }

    /// Put an item into the open list.
    #[inline]
    pub fn push(&mut self, item: T) {
        self.items.push(item);
    }

    /// End the open list.
    #[inline]
    pub fn close(&mut self) {
        self.start.push(self.items.len() as i32);
    }

    /// What the open list has so far.
    #[inline]
    pub fn open(&self) -> &[T] {
        &self.items[self.opened()..]
    }

    /// The same, to be changed.
    #[inline]
    pub fn open_mut(&mut self) -> &mut [T] {
        let opened = self.opened();
        &mut self.items[opened..]
    }

    /// List `i`.
    #[inline]
    pub fn list(&self, i: usize) -> &[T] {
        &self.items[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// How many lists are closed.
    #[inline]
    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Whether no list is closed.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn opened(&self) -> usize {
        self.start[self.len()] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_may_be_empty() {
        let mut lists = Lists::with_room(2);
        lists.close();
        lists.push('a');
        assert_eq!(lists.open(), ['a']);
        lists.close();
        assert_eq!((lists.list(0), lists.list(1)), (&[][..], &['a'][..]));
        assert!(lists.open().is_empty());
    }
}
