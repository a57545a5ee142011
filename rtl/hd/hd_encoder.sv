// Quantised frames to decisions: GS (eq. 1-3), GST over the last Window frames (eq. 4), nearest
// prototype in the frame's context (eq. 5). SliceWidth bits per cycle.
//
// Latency from the accepted frame to valid_o: Dim / SliceWidth + 5 cycles; a frame is accepted
// every Dim / SliceWidth cycles. All registers wait until a decision is taken.
//
// The window is updated incrementally. A product of bipolar vectors is its own inverse, hence
//   GST_t = rho(GST_t-1) * rho^N(GS_t-N) * GS_t,
// an XOR of three terms, with +1 (all ones) for frames before the window's start. rho rotates to
// the right: bit i comes from bit i + 1, so a slice of a rotated vector needs bits of the slice
// above.

module hd_encoder
  import hd_pkg::*;
#(
  parameter int unsigned Dim = 1000,
  parameter int unsigned Window = 15,       // at least 4: GS is stored 3 cycles after its frame
  parameter int unsigned SliceWidth = Dim,  // divides Dim; at least 2
  parameter bit BlockRam = 1'b0,            // CIM and history in block RAM
  parameter string ItemFile = "",           // IM: 12 rows
  parameter string LevelFile = "",          // CIM: 21 rows
  parameter string ContextFile = "",        // CM: 4 rows
  parameter string PrototypeFile = "",      // AM: 3 rows
  localparam int unsigned DistWidth = $clog2(Dim + 1)
) (
  input logic clk_i,
  input logic rst_ni,
  input logic tie_one_i,  // constant: value of a bit whose bundle is tied

  input  logic   valid_i,
  output logic   ready_o,
  input  frame_t frame_i,

  output logic                                 valid_o,
  input  logic                                 ready_i,
  output class_e                               class_o,
  output logic [NumClasses-1:0][DistWidth-1:0] distance_o
);

  localparam int unsigned NumSlices = Dim / SliceWidth;
  localparam int unsigned IndexWidth = index_width(NumSlices);
  localparam int unsigned NumSlots = Window + 1;  // the one being written, and Window complete ones
  localparam int unsigned SlotWidth = index_width(NumSlots);
  localparam int unsigned FillWidth = index_width(Window + 1);
  typedef logic [SliceWidth-1:0] slice_t;
  typedef logic [IndexWidth-1:0] index_t;
  typedef logic [SlotWidth-1:0] slot_t;
  typedef logic [FillWidth-1:0] fill_t;

  localparam index_t LastSlice = index_t'(NumSlices - 1);

  // rho^Window shifts by whole slices and by bits.
  localparam int unsigned SliceShift = (Window / SliceWidth) % NumSlices;
  localparam int unsigned BitShift = Window % SliceWidth;

  if (Dim % SliceWidth != 0) begin : gen_check_slices
    $fatal(1, "SliceWidth must divide Dim");
  end
  // rho takes all bits of a slice but one from the slice itself.
  if (SliceWidth < 2) begin : gen_check_slice_width
    $fatal(1, "SliceWidth must be at least 2");
  end
  if (Window < 4) begin : gen_check_window
    $fatal(1, "Window must be at least 4");
  end

  logic advance;
  assign advance = !valid_o || ready_i;

  // Data that travels with a slice down the pipeline.
  typedef struct packed {
    slice_tag_t place;
    index_t     slice;
    context_t   ctx;
    slot_t      slot;      // of the history, to be written
    logic       has_last;  // GST_t-1 belongs to this window
    logic       has_left;  // GS_t-N belongs to this window
  } tag_t;

  // Issue: the first slice of a frame directly, the others from the held frame.
  frame_t frame;
  index_t slice;
  logic issue;

  if (NumSlices == 1) begin : gen_whole
    assign ready_o = advance;
    assign frame = frame_i;
    assign slice = '0;
    assign issue = valid_i;
  end else begin : gen_sliced
    index_t slice_q;
    frame_t frame_q;
    assign ready_o = advance && (slice_q == '0);
    assign frame = (slice_q == '0) ? frame_i : frame_q;
    assign slice = slice_q;
    assign issue = valid_i || (slice_q != '0);

    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) begin
        slice_q <= '0;
        frame_q <= '0;
      end else if (advance && issue) begin
        slice_q <= (slice_q == LastSlice) ? '0 : slice_q + 1'b1;
        frame_q <= frame;
      end
    end
  end

  // Window: number of its frames, and the ring slot of the next one.
  slot_t slot_q, next_slot;
  fill_t fill_q, fill;
  assign fill = frame.first ? '0 : fill_q;
  assign next_slot = (slot_q == slot_t'(NumSlots - 1)) ? '0 : slot_q + 1'b1;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      slot_q <= '0;
      fill_q <= '0;
    end else if (advance && issue && (slice == LastSlice)) begin
      slot_q <= next_slot;
      fill_q <= (fill == fill_t'(Window)) ? fill : fill + 1'b1;
    end
  end

  tag_t issue_tag;
  assign issue_tag = '{
      place: '{
          valid: issue,
          first: slice == '0,
          last: slice == LastSlice,
          full: fill >= fill_t'(Window - 1)
      },
      slice: slice,
      ctx: frame.ctx,
      slot: slot_q,
      has_last: fill != '0,
      has_left: fill == fill_t'(Window)
  };

  // Read: CIM, IM, and the frame that leaves the window, the oldest of the ring.
  tag_t read_tag_q, gs_tag_q;
  slice_tag_t gst_tag_q;
  slice_t [NumPillars-1:0] level;
  slice_t [NumItems-1:0] item;
  slice_t left, gs_d, gs_q;
  index_t left_slice;

  logic [NumItems-1:0][index_width(NumItems)-1:0] item_row;
  for (genvar r = 0; r < NumItems; r++) begin : gen_item_row
    assign item_row[r] = r;
  end

  hd_item_memory #(
    .Rows      (NumLevels),
    .Dim       (Dim),
    .SliceWidth(SliceWidth),
    .NumPorts  (NumPillars),
    .BlockRam  (BlockRam),
    .InitFile  (LevelFile)
  ) u_level_memory (
    .clk_i,
    .advance_i(advance),
    .row_i    (frame.level),
    .slice_i  (slice),
    .slice_o  (level)
  );

  hd_item_memory #(
    .Rows      (NumItems),
    .Dim       (Dim),
    .SliceWidth(SliceWidth),
    .NumPorts  (NumItems),
    .InitFile  (ItemFile)
  ) u_item_memory (
    .clk_i,
    .advance_i(advance),
    .row_i    (item_row),
    .slice_i  (slice),
    .slice_o  (item)
  );

  assign left_slice = index_t'((32'(slice) + SliceShift) % NumSlices);

  hd_history #(
    .NumSlots  (NumSlots),
    .NumSlices (NumSlices),
    .SliceWidth(SliceWidth),
    .BlockRam  (BlockRam)
  ) u_history (
    .clk_i,
    .advance_i    (advance),
    .write_i      (gs_tag_q.place.valid),
    .write_slot_i (gs_tag_q.slot),
    .write_slice_i(gs_tag_q.slice),
    .slice_i      (gs_q),
    .read_slot_i  (next_slot),
    .read_slice_i (left_slice),
    .slice_o      (left)
  );

  // GS.
  slice_t left_q;  // delayed to match gs_q, while `left` already belongs to the slice above

  hd_bundle #(
    .Width(SliceWidth)
  ) u_bundle (
    .tie_one_i,
    .level_i(level),
    .item_i (item),
    .gs_o   (gs_d)
  );

  // GST. The newest slice enters at the top and moves down as the next ones come; after a frame
  // every slice is in its place.
  logic [Dim-1:0] gst_q, gst_d;
  slice_t last_rotated, left_rotated, left_above;
  logic last_above;

  if (NumSlices == 1) begin : gen_above_whole
    assign left_above = left_q;
    assign last_above = gst_q[0];
    assign gst_d = last_rotated ^ left_rotated ^ gs_q;
  end else begin : gen_above_sliced
    // Above the last slice is the first one, which is overwritten by then.
    slice_t left0_q;
    logic gst0_q;
    always_ff @(posedge clk_i) begin
      if (advance && gs_tag_q.place.valid && gs_tag_q.place.first) begin
        left0_q <= left_q;
        gst0_q  <= gst_q[0];
      end
    end
    assign left_above = gs_tag_q.place.last ? left0_q : left;
    assign last_above = gs_tag_q.place.last ? gst0_q : gst_q[SliceWidth];
    assign gst_d = {last_rotated ^ left_rotated ^ gs_q, gst_q[Dim-1:SliceWidth]};
  end

  always_comb begin
    last_rotated = '1;
    left_rotated = '1;
    if (gs_tag_q.has_last) last_rotated = {last_above, gst_q[SliceWidth-1:1]};
    if (gs_tag_q.has_left) left_rotated = slice_t'({left_above, left_q} >> BitShift);
  end

  // Prototypes in the context of the frame.
  slice_t [NumClasses-1:0] prototype, in_context;
  slice_t [0:0] cv;
  logic [NumClasses-1:0][index_width(NumClasses)-1:0] prototype_row;
  for (genvar k = 0; k < NumClasses; k++) begin : gen_prototype
    assign prototype_row[k] = k;
    assign in_context[k] = ~(prototype[k] ^ cv[0]);
  end

  hd_item_memory #(
    .Rows      (NumClasses),
    .Dim       (Dim),
    .SliceWidth(SliceWidth),
    .NumPorts  (NumClasses),
    .InitFile  (PrototypeFile)
  ) u_prototype_memory (
    .clk_i,
    .advance_i(advance),
    .row_i    (prototype_row),
    .slice_i  (gs_tag_q.slice),
    .slice_o  (prototype)
  );

  hd_item_memory #(
    .Rows      (NumContexts),
    .Dim       (Dim),
    .SliceWidth(SliceWidth),
    .NumPorts  (1),
    .InitFile  (ContextFile)
  ) u_context_memory (
    .clk_i,
    .advance_i(advance),
    .row_i    (gs_tag_q.ctx),
    .slice_i  (gs_tag_q.slice),
    .slice_o  (cv)
  );

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      read_tag_q <= '0;
      gs_tag_q   <= '0;
      gst_tag_q  <= '0;
    end else if (advance) begin
      read_tag_q <= issue_tag;
      gs_tag_q   <= read_tag_q;
      gst_tag_q  <= gs_tag_q.place;
    end
  end

  // The tags ensure that nothing here is read before it is written.
  always_ff @(posedge clk_i) begin
    if (advance) begin
      gs_q   <= gs_d;
      left_q <= left;
      if (gs_tag_q.place.valid) gst_q <= gst_d;
    end
  end

  hd_distance #(
    .Dim       (Dim),
    .SliceWidth(SliceWidth)
  ) u_distance (
    .clk_i,
    .rst_ni,
    .advance_i  (advance),
    .tag_i      (gst_tag_q),
    .query_i    (gst_q[Dim-1-:SliceWidth]),
    .prototype_i(in_context),
    .valid_o,
    .class_o,
    .distance_o
  );

endmodule
