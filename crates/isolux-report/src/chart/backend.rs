//! Where the plotting library draws: SVG whose colours, widths and fonts are left to the style sheet of the page.
//!
//! The library's own SVG backend writes fixed colours, which suit light pages or dark ones, but not both, and whole
//! pixels. This one takes tenths of a pixel, and writes classes where the library passes colours.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use plotters::style::RGBColor;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

use crate::markup::{Escaped, put};

/// Drawing units in a pixel of the page.
pub(super) const UNITS: i32 = 10;

/// What an element is; the style sheet says how it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Role {
    Minor,
    Grid,
    Axis,
    Tick,
    Label,
    Mark,
    MarkLabel,
    Data,
}

impl Role {
    const ALL: [Self; 8] = [
        Self::Minor,
        Self::Grid,
        Self::Axis,
        Self::Tick,
        Self::Label,
        Self::Mark,
        Self::MarkLabel,
        Self::Data,
    ];

    /// The colour that stands for the role on its way through the library.
    pub(super) const fn colour(self) -> RGBColor {
        RGBColor(self as u8, 0, 0)
    }

    fn of(colour: BackendColor) -> Self {
        Self::ALL.get(usize::from(colour.rgb.0)).copied().unwrap_or(Self::Data)
    }

    const fn class(self) -> &'static str {
        match self {
            Self::Minor => "minor",
            Self::Grid => "grid",
            Self::Axis => "axis",
            Self::Tick => "tick",
            Self::Label => "label",
            Self::Mark => "mark",
            Self::MarkLabel => "mark-label",
            Self::Data => "line",
        }
    }
}

/// The SVG as far as it is written.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    svg: String,
    /// Whether the last element is a path of markers that takes more of them.
    markers_open: bool,
}

impl Canvas {
    /// Appends markup, after what was drawn so far.
    pub(super) fn push(&mut self, markup: &str) {
        self.close_markers();
        self.svg.push_str(markup);
    }

    /// All that was drawn.
    pub(super) fn take(&mut self) -> String {
        self.close_markers();
        std::mem::take(&mut self.svg)
    }

    fn close_markers(&mut self) {
        if std::mem::take(&mut self.markers_open) {
            self.svg.push_str("\"/>\n");
        }
    }

    /// Markers of a series share one path: thousands of elements would make pages slow.
    fn open_markers(&mut self) -> &mut String {
        if !std::mem::replace(&mut self.markers_open, true) {
            self.svg.push_str("<path class=\"dots\" d=\"");
        }
        &mut self.svg
    }
}

/// A canvas that the library and the caller write to in turn.
#[derive(Clone, Debug)]
pub(super) struct StyledSvg {
    size: (u32, u32),
    canvas: Rc<RefCell<Canvas>>,
}

impl StyledSvg {
    /// A backend for a canvas of `size` drawing units.
    pub(super) fn new(size: (u32, u32), canvas: Rc<RefCell<Canvas>>) -> Self {
        Self { size, canvas }
    }
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Drawing units as pixels, with a decimal where there is one.
fn pixels(units: i32) -> f64 {
    f64::from(units) / f64::from(UNITS)
}

fn put_path(out: &mut String, points: impl IntoIterator<Item = BackendCoord>) {
    for (index, (x, y)) in points.into_iter().enumerate() {
        put!(out, "{}{} {}", if index == 0 { 'M' } else { 'L' }, pixels(x), pixels(y));
    }
}

impl DrawingBackend for StyledSvg {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.draw_circle(point, UNITS as u32 / 2, &color, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let mut canvas = self.canvas.borrow_mut();
        canvas.push("");
        put!(canvas.svg, "<path class=\"{}\" d=\"", Role::of(style.color()).class());
        put_path(&mut canvas.svg, path);
        canvas.svg.push_str("\"/>\n");
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, _: &S, _: bool) -> Drawn {
        let mut canvas = self.canvas.borrow_mut();
        let r = pixels(radius as i32);
        let (x, y) = (pixels(centre.0 - radius as i32), pixels(centre.1));
        put!(canvas.open_markers(), "M{x} {y}a{r} {r} 0 1 0 {} 0a{r} {r} 0 1 0 -{} 0z", 2.0 * r, 2.0 * r);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        _: &S,
    ) -> Drawn {
        let mut canvas = self.canvas.borrow_mut();
        let out = canvas.open_markers();
        put_path(out, corners);
        out.push('z');
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Right => "end",
            HPos::Center => "middle",
        };
        // From the wanted edge of the letters to their base line.
        let shift = match style.anchor().v_pos {
            VPos::Top => "0.78em",
            VPos::Center => "0.35em",
            VPos::Bottom => "-0.22em",
        };
        let mut canvas = self.canvas.borrow_mut();
        canvas.push("");
        put!(
            canvas.svg,
            "<text class=\"{}\" x=\"{}\" y=\"{}\" dy=\"{shift}\" text-anchor=\"{anchor}\">{}</text>\n",
            Role::of(style.color()).class(),
            pixels(x),
            pixels(y),
            Escaped(text)
        );
        Ok(())
    }
}
