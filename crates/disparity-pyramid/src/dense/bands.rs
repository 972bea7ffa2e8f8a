/// Bands for each thread, so that one that is held up leaves work to the others.
const BANDS_A_THREAD: usize = 4;

/// Rooms for the bands of rows that the threads of the current pool share, and how many rows a band
/// of an image of this height has. What a room holds means nothing from band to band; it stays as
/// large as it has grown.
pub(crate) fn bands<T: Clone + Default>(rooms: &mut Vec<T>, height: usize) -> (&mut [T], usize) {
    let bands = match rayon::current_num_threads() {
        1 => 1,
        threads => BANDS_A_THREAD * threads,
    };
    if rooms.len() < bands {
        rooms.resize(bands, T::default());
    }
    (&mut rooms[..bands], height.div_ceil(bands))
}
