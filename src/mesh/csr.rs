//! Rows of different lengths in one flat array.

/// Rows of indices: row `i` is `items[offsets[i]..offsets[i + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Csr {
    offsets: Vec<u32>,
    items: Vec<u32>,
}

impl Csr {
    /// Faces around each vertex, in ascending order; every index is in range.
    pub(super) fn faces_of_vertices(vertex_count: usize, faces: &[[u32; 3]]) -> Csr {
        let mut offsets = vec![0u32; vertex_count + 1];
        for vertex in faces.iter().flatten() {
            offsets[*vertex as usize + 1] += 1;
        }
        for i in 0..vertex_count {
            offsets[i + 1] += offsets[i];
        }
        let mut cursor = offsets.clone();
        let mut items = vec![0u32; 3 * faces.len()];
        for (face, corners) in faces.iter().enumerate() {
            for vertex in corners {
                let slot = &mut cursor[*vertex as usize];
                items[*slot as usize] = face as u32;
                *slot += 1;
            }
        }
        Csr { offsets, items }
    }

    /// No rows yet; `push` and `end_row` fill it.
    pub(super) fn with_capacity(rows: usize, items: usize) -> Csr {
        let mut offsets = Vec::with_capacity(rows + 1);
        offsets.push(0);
        Csr { offsets, items: Vec::with_capacity(items) }
    }

    pub(super) fn push(&mut self, item: u32) {
        self.items.push(item);
    }

    pub(super) fn end_row(&mut self) {
        self.offsets.push(self.items.len() as u32);
    }

    pub(super) fn row(&self, row: usize) -> &[u32] {
        &self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }

    pub(super) fn row_mut(&mut self, row: usize) -> &mut [u32] {
        &mut self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }

    pub(super) fn rows(&self) -> usize {
        self.offsets.len() - 1
    }
}
