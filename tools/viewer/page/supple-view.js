// <supple-view src token view>: the viewer in a page of somebody else, as one module without any other. The program
// shows itself in pages of the origins alone that `supple view --embed ORIGIN` names.
//
//   src    address of the program, as it prints it, with or without the token behind #
//   token  the token, where src has none
//   view   what is seen: the part of a link from `&view=` on
//
// Events of the element, lengths and places in mm, LPS: `ready`; `crosshair` {lps, voxel}; `stroke` {kind, text,
// isUndone, lps, rest_lps}; `saved` {what, path, bytes}; `refused` {text}, where the program does not answer this page.

const kAnswerMs = 8000;
const kEvents = ['ready', 'crosshair', 'stroke', 'saved'];

class SuppleView extends HTMLElement {
  static observedAttributes = ['src', 'token', 'view'];

  constructor() {
    super();
    this.frame = document.createElement('iframe');
    this.frame.allow = 'clipboard-write; fullscreen';
    this.frame.title = 'Supple';
    this.frame.style.cssText = 'border: 0; width: 100%; height: 100%; display: block';
    this.frame.addEventListener('load', () => this.greet());
    this.hear = (event) => this.heard(event);
    const home = this.attachShadow({mode: 'closed'});
    const style = document.createElement('style');
    style.textContent = ':host { display: block; min-height: 20rem; }';
    home.append(style, this.frame);
  }
  connectedCallback() {
    window.addEventListener('message', this.hear);
    this.show();
  }
  disconnectedCallback() {
    window.removeEventListener('message', this.hear);
    clearTimeout(this.waiting);
    this.frame.removeAttribute('src');
  }
  attributeChangedCallback() { if (this.isConnected) this.show(); }

  show() {
    const src = this.getAttribute('src');
    if (!src) return;
    const address = new URL(src, document.baseURI);
    const [token] = address.hash.slice(1).split('&view=');
    const view = this.getAttribute('view');
    address.hash = (this.getAttribute('token') ?? token) + (view ? '&view=' + view.replace(/^&view=/, '') : '');
    this.origin = address.origin;
    if (this.frame.src === address.href) return;
    this.frame.src = address.href;
  }
  /// The viewer speaks to nobody who has not greeted it from an origin that may.
  greet() {
    if (!this.origin) return;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.tell('refused', {text: `supple view does not answer: is it there, and was it started with --embed ${location.origin}?`}), kAnswerMs);
    this.frame.contentWindow.postMessage({supple: 'hello'}, this.origin);
  }
  heard({source, origin, data}) {
    if (source !== this.frame.contentWindow || origin !== this.origin || !kEvents.includes(data?.supple)) return;
    if (data.supple === 'ready') clearTimeout(this.waiting);
    this.tell(data.supple, data.detail);
  }
  tell(name, detail) { this.dispatchEvent(new CustomEvent(name, {detail, bubbles: true})); }
}

if (!customElements.get('supple-view')) customElements.define('supple-view', SuppleView);
