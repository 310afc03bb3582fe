//! Pictures as trackers and the screen need them: 8-bit luma, with half-size chroma where there is colour.

/// A borrowed 8-bit luma picture; rows are `stride` bytes apart.
#[derive(Clone, Copy, Debug)]
pub struct Gray<'a> {
    /// Pixels, row-major; at least `(height - 1) * stride + width` bytes.
    pub data: &'a [u8],
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Bytes from one row to the next, at least `width`.
    pub stride: usize,
}

impl<'a> Gray<'a> {
    /// A view on tightly packed rows.
    ///
    /// # Panics
    /// When `data` is not `width * height` bytes.
    #[must_use]
    #[track_caller]
    pub fn packed(data: &'a [u8], width: u32, height: u32) -> Self {
        assert_eq!(data.len(), width as usize * height as usize, "luma plane of {width}x{height}");
        Self { data, width, height, stride: width as usize }
    }

    /// Whether there are pixels, and `data` holds as many as the numbers say.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let bytes = (self.height as usize).saturating_sub(1).checked_mul(self.stride);
        let bytes = bytes.and_then(|bytes| bytes.checked_add(self.width as usize));
        self.width > 0
            && self.height > 0
            && self.stride >= self.width as usize
            && bytes.is_some_and(|n| n <= self.data.len())
    }

    /// Whether a position `[x, y]`, pixels, lies on the picture, which reaches half a pixel beyond its outermost centres.
    #[must_use]
    pub fn holds(&self, [x, y]: [f32; 2]) -> bool {
        let [right, bottom] = [self.width, self.height].map(|size| size as f32 - 0.5);
        (-0.5..=right).contains(&x) && (-0.5..=bottom).contains(&y)
    }

    /// One row, `width` bytes.
    ///
    /// # Panics
    /// When `y` is not a row of the picture.
    #[must_use]
    #[track_caller]
    pub fn row(&self, y: u32) -> &'a [u8] {
        assert!(y < self.height, "row {y} of {}", self.height);
        let start = y as usize * self.stride;
        &self.data[start..start + self.width as usize]
    }
}

/// Borrowed 8-bit chroma planes, as coded: 128 is no colour.
#[derive(Clone, Copy, Debug)]
pub struct Chroma<'a> {
    /// Blue difference.
    pub cb: Gray<'a>,
    /// Red difference, of the same size.
    pub cr: Gray<'a>,
}

impl Chroma<'_> {
    /// Whether both planes are whole, laid out alike, and not larger than a picture of this many pixels.
    #[must_use]
    pub fn fits(&self, width: u32, height: u32) -> bool {
        let layout = |plane: &Gray<'_>| (plane.width, plane.height, plane.stride);
        let small = self.cb.width <= width && self.cb.height <= height;
        self.cb.is_whole() && self.cr.is_whole() && small && layout(&self.cb) == layout(&self.cr)
    }
}

/// Which bytes mean black and white in the luma plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Range {
    /// 16 is black, 235 white (most video).
    Limited,
    /// 0 is black, 255 white (images).
    #[default]
    Full,
}

/// The borrowed planes of a frame: luma, and chroma at half size (4:2:0, rounded up) where there is colour.
#[derive(Clone, Copy, Debug)]
pub struct Planes<'a> {
    /// Luma as coded, `(height, width)`; what trackers see.
    pub y: Gray<'a>,
    /// Blue and red difference, each `(ceil(height/2), ceil(width/2))`, packed; `None` for gray clips.
    pub uv: Option<(&'a [u8], &'a [u8])>,
    /// Meaning of the luma bytes.
    pub range: Range,
}

impl<'a> Planes<'a> {
    /// The chroma planes with their size, where there is colour.
    #[must_use]
    pub fn chroma(&self) -> Option<Chroma<'a>> {
        let (width, height) = (self.y.width.div_ceil(2), self.y.height.div_ceil(2));
        let plane = |data| Gray { data, width, height, stride: width as usize };
        self.uv.map(|(cb, cr)| Chroma { cb: plane(cb), cr: plane(cr) })
    }

    /// Colour of a pixel as RGB (BT.601, the convention of SD video and JPEG).
    ///
    /// # Panics
    /// When (x, y) lies outside the picture.
    #[must_use]
    #[track_caller]
    pub fn rgb(&self, x: u32, y: u32) -> [u8; 3] {
        assert!(x < self.y.width && y < self.y.height, "pixel ({x}, {y})");
        let luma = f32::from(self.y.data[y as usize * self.y.stride + x as usize]);
        let half_width = self.y.width.div_ceil(2) as usize;
        let chroma_at = (y / 2) as usize * half_width + (x / 2) as usize;
        let (cb, cr) = self
            .uv
            .map_or((0.0, 0.0), |(u, v)| (f32::from(u[chroma_at]) - 128.0, f32::from(v[chroma_at]) - 128.0));
        let (luma, chroma_gain) = match self.range {
            Range::Full => (luma, 1.0),
            Range::Limited => ((luma - 16.0) * (255.0 / 219.0), 255.0 / 224.0),
        };
        let (cb, cr) = (cb * chroma_gain, cr * chroma_gain);
        [luma + 1.402 * cr, luma - 0.344_136 * cb - 0.714_136 * cr, luma + 1.772 * cb]
            .map(|c| c.round().clamp(0.0, 255.0) as u8)
    }
}
