// Constant hypervectors, read one slice at a time: all ports return the same slice, each of its own
// row, one cycle later.
//
// The file holds one row per line as $readmemh reads it: ceil(Dim / 4) digits, the most significant
// first.

module hd_item_memory
  import hd_pkg::*;
#(
  parameter int unsigned Rows = 1,
  parameter int unsigned Dim = 1000,
  parameter int unsigned SliceWidth = Dim,  // divides Dim
  parameter int unsigned NumPorts = 1,
  parameter bit BlockRam = 1'b0,            // block RAM, one copy per port; otherwise logic
  parameter string InitFile = "",           // "": undefined until a testbench writes `words`
  localparam int unsigned NumSlices = Dim / SliceWidth,
  localparam int unsigned RowWidth = index_width(Rows),
  localparam int unsigned IndexWidth = index_width(NumSlices)
) (
  input  logic                                clk_i,
  input  logic                                advance_i,
  input  logic [NumPorts-1:0][RowWidth-1:0]   row_i,
  input  logic [IndexWidth-1:0]               slice_i,
  output logic [NumPorts-1:0][SliceWidth-1:0] slice_o
);

  // Block RAM is filled without gaps; in logic, rows that start at powers of two need no adder.
  localparam int unsigned Stride = BlockRam ? NumSlices : 2 ** $clog2(NumSlices);
  localparam int unsigned Depth = Rows * Stride;
  localparam int unsigned AddrWidth = index_width(Depth);
  typedef logic [AddrWidth-1:0] addr_t;

  addr_t [NumPorts-1:0] addr;
  for (genvar p = 0; p < NumPorts; p++) begin : gen_addr
    assign addr[p] = addr_t'(row_i[p]) * addr_t'(Stride) + addr_t'(slice_i);
  end

  if (BlockRam) begin : gen_words
    (* rom_style = "block" *) logic [SliceWidth-1:0] words[Depth];
  end else begin : gen_words
    (* rom_style = "logic" *) logic [SliceWidth-1:0] words[Depth];
  end

  if (InitFile != "") begin : gen_init
    initial begin : init
      automatic logic [Dim-1:0] vectors[Rows];
      $readmemh(InitFile, vectors);
      for (int unsigned row = 0; row < Rows; row++) begin
        for (int unsigned slice = 0; slice < NumSlices; slice++) begin
          gen_words.words[row*Stride+slice] = vectors[row][slice*SliceWidth+:SliceWidth];
        end
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (advance_i) begin
      for (int unsigned p = 0; p < NumPorts; p++) slice_o[p] <= gen_words.words[addr[p]];
    end
  end

endmodule
