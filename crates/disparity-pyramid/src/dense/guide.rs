use crate::dense::EyeView;

/// The picture that says where surfaces end: one channel or three, 8 bits each, channel by channel.
#[derive(Debug)]
pub(crate) struct Guide {
    width: usize,
    height: usize,
    /// Planes in row-major order, one a channel.
    channels: Vec<Vec<u8>>,
    /// How far each pixel's colour lies from the next one's on its row, and from the one below, in
    /// steps of 8 bits; 0 where there is none.
    beside: Vec<u8>,
    below: Vec<u8>,
}

impl Guide {
    /// The colours of a view, or its luma in 256 steps from 0 to 1 if it has none or they are not
    /// asked for.
    pub(crate) fn of(view: &EyeView<'_>, colour: bool) -> Self {
        let size = view.luma.size();
        let channels = match view.rgb.filter(|_| colour) {
            Some(rgb) => (0..3)
                .map(|channel| rgb.iter().map(|colour| colour[channel]).collect())
                .collect(),
            None => {
                // Half a step more rounds, as what is below nothing becomes nothing.
                let grey = |luma: &f32| (luma * 255.0 + 0.5) as u8;
                let rows = view.luma.plane();
                let Some(luma) = rows.to_slice() else {
                    unreachable!("a picture is kept in row-major order")
                };
                vec![luma.iter().map(grey).collect()]
            }
        };
        Self::new(size.width, size.height, channels)
    }

    fn new(width: usize, height: usize, channels: Vec<Vec<u8>>) -> Self {
        let area = width * height;
        let mut beside = steps(&channels, 1);
        beside.resize(area, 0);
        // The last pixel of a row has no next one.
        for last in beside.chunks_mut(width).filter_map(<[u8]>::last_mut) {
            *last = 0;
        }
        let mut below = steps(&channels, width);
        below.resize(area, 0);
        Self {
            width,
            height,
            channels,
            beside,
            below,
        }
    }

    /// The same picture with left and right exchanged.
    pub(crate) fn mirrored(&self) -> Self {
        let mirror = |plane: &Vec<u8>| {
            let rows = plane.chunks(self.width);
            rows.flat_map(|row| row.iter().rev().copied()).collect()
        };
        let channels = self.channels.iter().map(mirror).collect();
        Self::new(self.width, self.height, channels)
    }

    pub(crate) const fn width(&self) -> usize {
        self.width
    }

    pub(crate) const fn height(&self) -> usize {
        self.height
    }

    /// How many channels there are.
    pub(crate) const fn channels(&self) -> usize {
        self.channels.len()
    }

    /// One channel, row-major.
    pub(crate) fn plane(&self, channel: usize) -> &[u8] {
        &self.channels[channel]
    }

    /// How far two pixels' colours lie apart, in steps of 8 bits: the mean over the channels, which
    /// the noise of one does not carry.
    #[cfg(test)]
    pub(crate) fn step(&self, one: usize, other: usize) -> u8 {
        let step = |plane: &Vec<u8>| u16::from(plane[one].abs_diff(plane[other]));
        let sum: u16 = self.channels.iter().map(step).sum();
        (sum / self.channels.len() as u16) as u8
    }

    /// The steps from each pixel of a row to the next one.
    #[inline(always)]
    pub(crate) fn beside(&self, y: usize) -> &[u8] {
        &self.beside[y * self.width..(y + 1) * self.width]
    }

    /// The steps from each pixel of a row to the one below.
    #[inline(always)]
    pub(crate) fn below(&self, y: usize) -> &[u8] {
        &self.below[y * self.width..(y + 1) * self.width]
    }
}

/// How far each pixel's colour lies from that of the pixel `further` on, as long as there is one.
fn steps(channels: &[Vec<u8>], further: usize) -> Vec<u8> {
    let pairs = |plane| {
        let plane: &[u8] = plane;
        plane.iter().zip(plane.get(further..).unwrap_or_default())
    };
    match channels {
        [grey] => pairs(grey)
            .map(|(here, there)| here.abs_diff(*there))
            .collect(),
        [red, green, blue] => {
            let step = |(here, there): (&u8, &u8)| u16::from(here.abs_diff(*there));
            let others = pairs(green).zip(pairs(blue));
            let steps = pairs(red).zip(others);
            steps
                .map(|(red, (green, blue))| ((step(red) + step(green) + step(blue)) / 3) as u8)
                .collect()
        }
        _ => Vec::new(),
    }
}
