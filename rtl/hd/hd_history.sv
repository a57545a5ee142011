// Ring of the spatial vectors of past frames, one slice per word. A read in the cycle of a write
// returns the old word. Nothing is reset: the reader tracks how far the ring is filled.

module hd_history
  import hd_pkg::*;
#(
  parameter int unsigned NumSlots = 16,
  parameter int unsigned NumSlices = 1,
  parameter int unsigned SliceWidth = 1000,
  parameter bit BlockRam = 1'b0,
  localparam int unsigned SlotWidth = index_width(NumSlots),
  localparam int unsigned IndexWidth = index_width(NumSlices)
) (
  input  logic                  clk_i,
  input  logic                  advance_i,
  input  logic                  write_i,
  input  logic [ SlotWidth-1:0] write_slot_i,
  input  logic [IndexWidth-1:0] write_slice_i,
  input  logic [SliceWidth-1:0] slice_i,
  input  logic [ SlotWidth-1:0] read_slot_i,
  input  logic [IndexWidth-1:0] read_slice_i,
  output logic [SliceWidth-1:0] slice_o         // one cycle later
);

  localparam int unsigned Stride = 2 ** $clog2(NumSlices);
  localparam int unsigned AddrWidth = index_width(NumSlots * Stride);
  typedef logic [AddrWidth-1:0] addr_t;

  addr_t write_addr, read_addr;
  assign write_addr = addr_t'(write_slot_i) * addr_t'(Stride) + addr_t'(write_slice_i);
  assign read_addr = addr_t'(read_slot_i) * addr_t'(Stride) + addr_t'(read_slice_i);

  if (BlockRam) begin : gen_words
    (* ram_style = "block" *) logic [SliceWidth-1:0] words[2**AddrWidth];
  end else begin : gen_words
    (* ram_style = "distributed" *) logic [SliceWidth-1:0] words[2**AddrWidth];
  end

  always_ff @(posedge clk_i) begin
    if (advance_i) begin
      if (write_i) gen_words.words[write_addr] <= slice_i;
      slice_o <= gen_words.words[read_addr];
    end
  end

endmodule
