//! Small pages, and what is looked for in them.

use isolux::Plane;
use isolux_report::page::{Axis, Block, Chart, Colours, Page, Picture, Scale, Section, Series};
use roxmltree::{Document, Node, ParsingOptions};

pub(crate) fn parse(html: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(html, options).unwrap_or_else(|error| panic!("{error}\n{html}"))
}

pub(crate) fn all<'a>(document: &'a Document<'a>, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| node.tag_name().name() == name)
}

pub(crate) fn has_class(node: Node<'_, '_>, class: &str) -> bool {
    node.attribute("class").is_some_and(|classes| classes.split(' ').any(|found| found == class))
}

fn axis(scale: Scale) -> Axis {
    Axis { label: "x in m".into(), scale, range: None }
}

pub(crate) fn chart(id: &str, scale: Scale, series: Vec<Series>) -> Chart {
    Chart {
        id: id.into(),
        caption: "c".into(),
        alt: "a".into(),
        x: axis(scale),
        y: axis(scale),
        series,
        marks: vec![],
    }
}

pub(crate) fn picture(id: &str, values: Plane<f32>, range: (f32, f32)) -> Picture {
    let label = "amplitude in DN".into();
    Picture {
        id: id.into(),
        caption: "c".into(),
        alt: "a".into(),
        values,
        range,
        label,
        colours: Colours::Viridis,
    }
}

pub(crate) fn page(blocks: Vec<Block>) -> Page {
    let section = Section { id: "only".into(), title: "Only".into(), blocks };
    Page { title: "t".into(), lead: String::new(), sections: vec![section], colophon: String::new() }
}
