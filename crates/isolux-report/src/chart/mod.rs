//! Charts: curves over two axes as SVG.

mod curves;
mod draw;
mod figure;
mod layout;
mod marker;
mod marks;
mod scale;
mod svg;
mod text;
mod ticks;

pub(crate) use figure::put_chart;
