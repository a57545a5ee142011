// Frames on a byte stream: samples in, decisions out.
//
//   request  A5, flags, 9 x (x, y, z) in Q13.3, two bytes each with the low one first, CRC   58 bytes
//   reply    5A, status, three distances, two bytes each with the low one first, CRC         10 bytes
//
// Flags: bit 0 starts a window with this sample; the others are zero. Status: the class, 0 while
// the window is not full, or an error with distances of zero: 80 checksum, 81 incomplete (a pause
// of more than two bytes, or a byte without a stop bit), 82 unknown flag. The CRC is the CRC-16
// with polynomial 1021 and start FFFF over all bytes between mark and CRC, high byte first, so that
// it is 0 over frame and CRC.
//
// Every request is answered once and in order. Of several errors during a reply, the last is
// answered. After an error the start of the next frame is unknown, so bytes are dropped without a
// reply until the line has paused for more than two bytes. The rest of a broken frame is therefore
// no request, and the next request must follow a pause. A host that waits for each reply always
// leaves one; any other host must insert one and resend what was dropped. In a pause and after a
// good frame a mark begins a frame, and other bytes are ignored: if a frame lost its mark or
// stalled, its remaining bytes are searched for a mark.

module hd_host
  import hd_pkg::*;
#(
  parameter int unsigned ClkPerBit = 100,
  parameter int unsigned DistWidth = 10    // at most 16
) (
  input logic clk_i,
  input logic rst_ni,

  input logic       rx_valid_i,
  input logic [7:0] rx_data_i,
  input logic       rx_error_i,

  output logic       tx_valid_o,
  input  logic       tx_ready_i,
  output logic [7:0] tx_data_o,

  output logic                   sample_valid_o,
  input  logic                   sample_ready_i,
  output logic                   sample_first_o,
  output disp_t [NumPillars-1:0] sample_disp_o,

  input  logic                                 valid_i,
  output logic                                 ready_o,
  input  class_e                               class_i,
  input  logic [NumClasses-1:0][DistWidth-1:0] distance_i
);

  localparam logic [7:0] RequestMark = 8'hA5;
  localparam logic [7:0] ReplyMark = 8'h5A;
  localparam int unsigned CrcBytes = 2;
  localparam int unsigned SampleBytes = NumPillars * $bits(disp_t) / 8;
  localparam int unsigned RequestBytes = 1 + SampleBytes + CrcBytes;  // without the mark
  localparam int unsigned ReplyBytes = 2 + 2 * NumClasses;            // without the CRC

  typedef enum logic [7:0] {
    StatusChecksum   = 8'h80,
    StatusIncomplete = 8'h81,
    StatusFlag       = 8'h82
  } error_e;

  typedef logic [15:0] crc_t;
  localparam crc_t CrcStart = '1;
  function automatic crc_t crc_of(crc_t crc, logic [7:0] data);
    crc_t next;
    next = crc ^ {data, 8'h00};
    for (int unsigned i = 0; i < 8; i++) begin
      next = {next[14:0], 1'b0} ^ (next[15] ? 16'h1021 : 16'h0000);
    end
    return next;
  endfunction

  // Request. The bytes move down as they arrive, so that the first one ends lowest.
  localparam int unsigned PauseWidth = $clog2(30 * ClkPerBit);
  localparam logic [PauseWidth-1:0] LongestPause = PauseWidth'(30 * ClkPerBit - 1);

  typedef logic [$clog2(RequestBytes)-1:0] index_t;
  localparam index_t LastByte = index_t'(RequestBytes - 1);
  localparam index_t FirstCrcByte = index_t'(RequestBytes - CrcBytes);

  typedef enum logic [1:0] {
    StateHunt,     // for a mark
    StateReceive,  // a frame
    StatePause     // after an error, until the line is silent
  } state_e;
  state_e state_q;
  logic complete_q;
  index_t received_q;
  logic [RequestBytes-CrcBytes-1:0][7:0] request_q;
  logic [PauseWidth-1:0] pause_q;
  crc_t rx_crc_q, rx_crc;
  assign rx_crc = crc_of(rx_crc_q, rx_data_i);

  // A byte that ends together with the longest pause is in time.
  logic paused, last_byte, good_frame, incomplete;
  assign paused = (pause_q == LongestPause) && !rx_valid_i && !rx_error_i;
  assign last_byte = (state_q == StateReceive) && rx_valid_i && (received_q == LastByte);
  assign good_frame = last_byte && (rx_crc == '0) && (request_q[0][7:1] == '0);
  assign incomplete = (state_q == StateReceive) && (rx_error_i || paused);

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      state_q    <= StateHunt;
      complete_q <= 1'b0;
      received_q <= '0;
      request_q  <= '0;
      pause_q    <= '0;
      rx_crc_q   <= CrcStart;
    end else begin
      if (good_frame) begin
        complete_q <= 1'b1;
      end else if (sample_ready_i) begin
        complete_q <= 1'b0;
      end

      pause_q <= (rx_valid_i || rx_error_i) ? '0 : pause_q + 1'b1;
      unique case (state_q)
        StateHunt: begin
          if (rx_valid_i && (rx_data_i == RequestMark)) state_q <= StateReceive;
          received_q <= '0;
          rx_crc_q   <= CrcStart;
        end
        StateReceive: begin
          if (paused || good_frame) begin
            state_q <= StateHunt;
          end else if (rx_error_i || last_byte) begin
            state_q <= StatePause;
          end else if (rx_valid_i) begin
            received_q <= received_q + 1'b1;
            rx_crc_q   <= rx_crc;
            // The CRC itself is not stored.
            if (received_q < FirstCrcByte) begin
              request_q <= {rx_data_i, request_q[RequestBytes-CrcBytes-1:1]};
            end
          end
        end
        default: if (paused) state_q <= StateHunt;
      endcase
    end
  end

  assign sample_valid_o = complete_q;
  assign sample_first_o = request_q[0][0];
  assign sample_disp_o = request_q[RequestBytes-CrcBytes-1:1];

  // Errors wait until the transmitter is free.
  logic error_pending_q, error_taken;
  error_e error_q;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      error_pending_q <= 1'b0;
      error_q         <= StatusChecksum;
    end else if (incomplete) begin
      error_pending_q <= 1'b1;
      error_q         <= StatusIncomplete;
    end else if (last_byte && !good_frame) begin
      error_pending_q <= 1'b1;
      error_q         <= (rx_crc == '0) ? StatusFlag : StatusChecksum;
    end else if (error_taken) begin
      error_pending_q <= 1'b0;
    end
  end

  // Reply: mark, status and distances, lowest byte first, then the CRC.
  logic [ReplyBytes-1:0][7:0] reply_q, answer;
  logic [3:0] to_send_q;  // bytes, CRC included
  crc_t tx_crc_q;
  logic sending;
  assign sending = to_send_q != '0;

  always_comb begin
    answer = '0;
    answer[0] = ReplyMark;
    if (valid_i) begin
      answer[1] = {6'd0, class_i};
      for (int unsigned k = 0; k < NumClasses; k++) answer[2+2*k+:2] = 16'(distance_i[k]);
    end else begin
      answer[1] = error_q;
    end
  end

  assign ready_o = !sending;
  assign error_taken = !sending && !valid_i;

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      reply_q   <= '0;
      to_send_q <= '0;
      tx_crc_q  <= CrcStart;
    end else if (!sending) begin
      if (valid_i || error_pending_q) begin
        reply_q   <= answer;
        to_send_q <= 4'(ReplyBytes + CrcBytes);
      end
      tx_crc_q <= CrcStart;
    end else if (tx_ready_i) begin
      reply_q   <= reply_q >> 8;
      to_send_q <= to_send_q - 1'b1;
      if (to_send_q <= 4'(CrcBytes)) begin
        tx_crc_q <= tx_crc_q << 8;
      end else if (to_send_q != 4'(ReplyBytes + CrcBytes)) begin
        tx_crc_q <= crc_of(tx_crc_q, reply_q[0]);
      end
    end
  end

  assign tx_valid_o = sending;
  assign tx_data_o = (to_send_q <= 4'(CrcBytes)) ? tx_crc_q[15:8] : reply_q[0];

endmodule
