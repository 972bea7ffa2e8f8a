use crate::dense::EyeView;

/// The picture that says where surfaces end: one channel or three, 8 bits each, channel by channel.
#[derive(Debug)]
pub(crate) struct Guide {
    width: usize,
    height: usize,
    /// Planes in row-major order, one a channel.
    channels: Vec<Vec<u8>>,
}

impl Guide {
    /// The colours of a view, or its luma in 256 steps from 0 to 1 if it has none.
    pub(crate) fn of(view: &EyeView<'_>) -> Self {
        let size = view.luma.size();
        let channels = match view.rgb {
            Some(rgb) => (0..3)
                .map(|channel| rgb.iter().map(|colour| colour[channel]).collect())
                .collect(),
            None => {
                let grey = |luma: &f32| (luma * 255.0).round() as u8;
                vec![view.luma.plane().iter().map(grey).collect()]
            }
        };
        Self {
            width: size.width,
            height: size.height,
            channels,
        }
    }

    /// The same picture with left and right exchanged.
    pub(crate) fn mirrored(&self) -> Self {
        let mirror = |plane: &Vec<u8>| {
            let rows = plane.chunks(self.width);
            rows.flat_map(|row| row.iter().rev().copied()).collect()
        };
        Self {
            channels: self.channels.iter().map(mirror).collect(),
            ..*self
        }
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
    #[inline(always)]
    pub(crate) fn step(&self, one: usize, other: usize) -> u8 {
        let steps = |plane: &Vec<u8>| plane[one].abs_diff(plane[other]);
        match &self.channels[..] {
            [grey] => steps(grey),
            channels => {
                let sum: usize = channels.iter().map(|plane| usize::from(steps(plane))).sum();
                // A mean of bytes is one.
                (sum / channels.len().max(1)) as u8
            }
        }
    }
}
