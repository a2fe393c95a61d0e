// For each file: DXGI format, width, height, levels, layers, and the bytes of each layer in hexadecimal.
use std::fs::File;

fn main() {
    for path in std::env::args().skip(1) {
        let dds = ddsfile::Dds::read(File::open(&path).unwrap()).expect(&path);
        let format = dds.get_dxgi_format().expect("no DXGI format") as u32;
        let layers = dds.get_num_array_layers();
        print!("{} {} {} {} {}", format, dds.get_width(), dds.get_height(), dds.get_num_mipmap_levels(), layers);
        for layer in 0..layers {
            let data = dds.get_data(layer).expect("no such layer");
            let text: String = data.iter().map(|byte| format!("{:02x}", byte)).collect();
            print!(" {}", text);
        }
        println!();
    }
}
